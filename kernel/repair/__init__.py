"""Meshes made of faces that are none, with as little change as can be.

A repair welds vertices at one place, then drops what is no face, cuts faces that pass a vertex
twice and splits T-junctions until nothing is left of these, then separates faces where more
than two meet and turns over the fewer of each piece. A mesh that wants nothing stays as it is,
number by number, and so does what was repaired once.

description  What a mesh is, and what can be done with it.
pipeline     The repair: all steps in their order, and what they did.
separation   Vertices of their own where faces meet and are no manifold; normals unified.
t_junctions  Vertices on the edge of a face that are no corner of it.
holes        Faces that pass a vertex twice, cut into triangles.
faces        Faces that are none: unusable, without area, repeated.
sides        Sides of faces, and which of them continue each other.
welding      Vertices at one place, within the digits of their coordinates.
raw_mesh     Faces that are not yet known to be a mesh, and where they come from.
"""
