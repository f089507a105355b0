"""Seamless maps to the plane whose coordinate lines follow the field.

In the order of the steps:

seams                   How coordinates of the faces are tied across the seams of a cut mesh.
boundary_alignment      Sides of the boundary that run along a direction become lines of the
                        map.
singularity_separation  Singular vertices close to each other, which shall not fall together.
coordinate              One coordinate: least squares in real numbers and integers.
integer_rounding        Whole-number minima of small quadratic functions under relations.
injectivity             Maps without flips: what is folded is unfolded near where it is.
parametrization         The whole map: both coordinates, without folds.
"""
