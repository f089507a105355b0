"""From a design surface to a pattern of panels, and what spheres will gain in it.

gain         What spheres will gain on a surface, and where.
hexagons     Convex hexagons, the smoothest over a grid of bounds.
quads        Quads along the lines of curvature, with a support structure.
reports      What is said of every pattern.
scales       A pattern with four times the faces, or a quarter.
semiregular  Patterns of triangles, squares, hexagons and octagons.
triangles    Triangles of nearly one size, with spheres of smallest angles.
"""
