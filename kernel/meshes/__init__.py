"""
Meshes of mixed face degrees: connectivity, curvature, subdivision, remeshing.

curvature       Normals and principal curvatures at the vertices of a mesh, seen as a smooth
                surface.
mesh            The mesh: vertices, and faces of mixed degree stored in compressed rows.
remeshing       Even triangles in place of whatever triangles came in.
subdivision     Subdivision: finer meshes, by midpoints or smooth in the limit.
surface_lines   Boundary and creases of a surface as curves by arc length, which edits of
                triangles keep to.
topology        Connectivity of a mesh of mixed face degrees, from its half-edges.
triangle_edges  Triangles that are being edited, their edges and shapes, as arrays.
triangle_edits  Splits, collapses and flips of the edges of a triangle mesh, many at a time.
triangulation   Cutting polygons into triangles along short diagonals.
"""
