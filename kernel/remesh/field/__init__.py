"""Conjugate directions of a congruence, as a smooth field over its mesh.

In the order of the steps:

congruence_mesh       Triangles with a sphere at every vertex, in the unit of the mean edge.
relax                 Before all else, where needed: congruences made fit to remesh.
jets                  Second derivatives of the spheres at the vertices, by local polynomials.
smooth_surface        The smooth surface that the same polynomials give.
conjugate_form        The quadratic form whose roots are the conjugate directions.
conjugate_directions  The directions themselves, and what nodes to expect.
smoothing             The signs of the forms, and their smoothing.
guides                Curves and directions that the field shall follow besides.
tree_signs            Signs under which neighbours are alike.
frames                Two directions in every triangle, combed, and their singularities.
"""
