"""Surfaces to start from: exactly circular nets, triangulated samples, NURBS and polysurfaces.

A polysurface is meshed in four steps: a plan for each face, numbers of edges that neighbours
share, quads or triangles in (u, v), and the vertices that faces have in common.

circular_nets     Exactly circular nets to start from: every face has a circumcircle.
face_meshes       Meshes on polysurfaces: faces that meet along common edges.
face_plans        How a face can be divided: as a grid, a fan, a disc, or into triangles.
nurbs             NURBS surfaces: exact points, derivatives and principal curvatures.
planar_grids      Quads on a region of the plane: grids, fans and discs.
planar_triangles  Triangles on any region of the plane, holes included.
poles             The shape of a surface also at poles and apexes.
row_counts        How many edges of a mesh stand on each edge of a polysurface.
smooth_pieces     Polysurfaces divided where surfaces and edges have kinks.
surface           A mesh on a smooth surface, with the exact shape of the surface.
triangulated      Triangulated sample surfaces with exact normals, to remesh and measure with.
trimmed_faces     Faces of polysurfaces: pieces of surfaces between trims, joined along edges.
vertex_shapes     The shape of surfaces at the vertices of a mesh on them.
"""
