"""
Conjugate directions of a congruence, as a smooth field over its mesh.

congruence_mesh  A triangle mesh with a sphere at every vertex, seen in the unit of its mean
                 edge.
conjugate        Conjugate directions of a sphere congruence: where two neighbouring spheres
                 of a net meet.
directions       Conjugate directions at the vertices of a triangulated sphere congruence.
frames           Two directions in every triangle, combed over the cut mesh, and their
                 singularities.
jets             Second derivatives of a sphere congruence at the vertices of a mesh, by local
                 polynomials.
relax            Relaxation of sphere congruences: towards real conjugate nets with upright
                 node axes.
smooth_surface   The smooth surface that a triangle mesh stands for, near its vertices a
                 polynomial.
smoothing        A field of quadratic forms over a triangle mesh: its signs, and its
                 smoothing.
tree_signs       Signs under which neighbours are alike.
"""
