"""Meshes of mixed face degrees: connectivity, curvature, subdivision, remeshing.

mesh            The mesh: vertices, and faces of mixed degree in compressed rows.
topology        Half-edges, edges and boundary of a mesh.
vertex_fans     The corners around vertices in counter-clockwise order.
curvature       Normals and principal curvatures at the vertices of a mesh.
triangulation   Cutting polygons into triangles along short diagonals.
subdivision     Finer meshes, by midpoints or smooth in the limit.
remeshing       Isotropic remeshing of triangle meshes.
surface_lines   Boundary and creases of a surface as curves, which edits keep to.
triangle_edges  Triangles that are being edited, their edges and shapes.
surface_lines   Boundary and creases of a surface as curves by arc length.
triangle_edits  Splits, collapses and flips of edges, many at a time.
"""
