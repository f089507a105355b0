"""Quadrilateral sphere meshes from congruences of spheres (Sec. 6.4).

`pipeline.remesh` is the order of the steps. The spheres around each vertex are fitted by
polynomials of degree 3, 5 or 7; Mallows' criterion picks one degree for the whole mesh, 7
where spheres are exact, less with noise. The conjugate form is made of five-by-five
determinants of these second jets, so it carries its sign: the first directions are one field
of lines, the second another, and only half turns (indices ±1/2) occur, no quarter turns. Where
the form vanishes along a curve, as on sheets bent to both sides, it is reversed beyond.

u and v are therefore two scalar problems with signs and whole-number shifts across seams;
shifts are conserved around vertices, like flows on a graph. The real unknowns are eliminated
with one factorisation, and integers are rounded on what is left. Lines at whole numbers and a
half give the net; its connectivity is decided by whole numbers alone. Nodes have valence 4;
around an index of -1/2 lies a hexagon, around 1/2 a cell of two corners, which becomes an
edge.

The net is not planar yet: `planar` changes its spheres and moves its nodes until beams meet
without torsion, on the smooth surface that the heights of the same fits give.

field     Conjugate directions of a congruence, as a smooth field over its mesh.
map       Seamless maps to the plane whose coordinate lines follow the field.
net       From the lines of a map to a net of nodes, edges and cells.
planar    Planarisation: nodes whose spheres share two points, so that beams have no torsion.
pipeline  From a sphere congruence to a net of spheres: `remesh`.
reports   Plain reports of nets: how a congruence was remeshed, how its nodes became planar.
"""
