"""Pure functions on arrays and frozen records: the mathematics.

analysis       Measures of meshes and sphere meshes: how flat, how circular, how upright, how
               near.
arrays         Array types and the few operations on rows of vectors that NumPy has no short
               name for.
beams          Beams: annuli of a thickness, cut at their nodes, and what is known of them.
congruences    Two-parameter families of spheres and their envelopes (Sec. 2.2, 2.3).
errors         What can go wrong, as types: the interfaces turn each into an exit code and one
               line.
hexagons       Hexagonal sphere meshes, dual to triangulations (Sec. 7).
meshes         Meshes of mixed face degrees: connectivity, curvature, subdivision, remeshing.
optimization   Spheres that meet smoothly, in few radii: angles, energy (6), strips, clusters
               (Sec. 3, 4, 6.3).
panels         Panels: pieces of spheres cut out by planes, what is known of them, and their
               moulds.
parts          What panels, beams and nodes are called, and what is said of them.
remesh         Quadrilateral sphere meshes from congruences of spheres (Sec. 6.4).
reports        Reports: records that read like dictionaries.
solvers        Solvers of least-squares problems and of the linear systems in them.
sphere_meshes  Meshes with a sphere for every face: fit, central spheres, maps, changes of
               model (Sec. 3, 5, 6.1).
spheres        Spheres, circles and arcs as rows of numbers, and the Möbius group (Sec. 2.1).
support        Support structures: node axes, torsion, and the flat annuli between them (Sec.
               4.1).
surfaces       Surfaces to start from: exactly circular nets, triangulated samples, NURBS.
tolerances     The only home of small numbers.
"""
