"""Meshes of mixed face degrees: connectivity, curvature, subdivision, remeshing.

Remeshing edits edges in batches of independent ones, so it stays numpy. Boundary and creases
are curves by arc length: an edit after which a curve would leave its edges by more than a
tenth of an edge is not made. Lengths that are equal but for rounding count as equal, and an
index decides: all processors make one mesh.

mesh                 The mesh: vertices, and faces of mixed degree in compressed rows.
faces                Faces in compressed rows; what keeps them from being a mesh.
topology             Half-edges, edges and boundary of a mesh.
defects              Why faces are no mesh, and what repairs it.
orientation          Which faces are to be turned over, so that neighbours agree.
creases              Edges at which a surface turns too sharply to be taken for smooth.
vertex_fans          The corners around vertices in counter-clockwise order.
curvature            Normals and principal curvatures at the vertices of a mesh.
triangulation        Cutting polygons into triangles along short diagonals.
subdivision          Finer meshes, by midpoints or smooth in the limit.
isotropic_remeshing  Isotropic remeshing of triangle meshes.
surface_lines        Boundary and creases of a surface as curves, which edits keep to.
triangle_edges       Triangles that are being edited, their edges and shapes.
triangle_edits       Splits, collapses and flips of edges, many at a time.
"""
