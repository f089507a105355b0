"""
Seamless maps to the plane whose coordinate lines follow the field.

boundary_alignment  Sides of the boundary that run along a direction of the field become lines
                    of the map.
coordinate          One coordinate of a seamless map: a least-squares problem in real numbers
                    and integers.
injectivity         Maps of triangles without flips: what is folded is unfolded near where it
                    is.
integers            Whole-number minima of small quadratic functions under whole-number
                    relations.
parametrization     Seamless maps to the plane whose coordinate lines follow two given
                    directions.
seams               How coordinates of the faces are tied across the seams of a cut mesh.
separation          Singular vertices close to each other, which shall not fall on the same
                    whole numbers.
"""
