"""
Two-parameter families of spheres and their envelopes (Sec. 2.2, 2.3).

envelopes  Discrete sphere congruences and the points that their spheres have in common.
smooth     Sphere congruences: two-parameter families of spheres, smooth and at the vertices
           of a mesh.
"""
