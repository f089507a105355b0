"""Pure functions on arrays and frozen records: the mathematics.

From the roof down; a room uses those below it.

patterns        From a design surface to a pattern of panels.
analysis        What is measured of a finished sphere mesh.
exact_supports  Nets that slide until beams and panels meet exactly.
clearances      How far parts are apart, and how deep they overlap.
remesh          Quadrilateral sphere meshes from congruences of spheres (Sec. 6.4).
beams           Beams: annuli of a thickness, cut at their nodes.
hexagons        Hexagonal sphere meshes, dual to triangulations (Sec. 7).
support         Node axes, torsion, and the flat annuli between them (Sec. 4.1).
panels          Pieces of spheres cut out by planes, and their moulds.
optimization    Spheres that meet smoothly, in few radii: angles, energy (6) (Sec. 3, 4, 6.3).
repair          Meshes made of faces that are none; what a mesh is.
congruences     Two-parameter families of spheres and their envelopes (Sec. 2.2, 2.3).
sphere_meshes   A sphere for every face: fit, central spheres, models (Sec. 3, 5, 6.1).
spheres         Spheres, circles and arcs as rows of numbers; the Möbius group (Sec. 2.1).
surfaces        Circular nets, triangulated samples and NURBS to start from.
meshes          Meshes of mixed face degrees: connectivity, curvature, remeshing.
solvers         Least squares and the linear systems in it.
parts           What panels, beams and nodes are called, and what is said of them.
display         How records show themselves: in a line, and in what floors above lend.
arrays          Array types, and the few operations on rows that NumPy has no short name for.
errors          What can go wrong, as types.
progress        How far a long computation has come, told to whoever listens.
reports         Records that read like dictionaries.
tolerances      The only home of small numbers.
"""
