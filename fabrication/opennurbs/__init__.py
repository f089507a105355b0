"""
The openNURBS byte stream: exact Breps and render meshes, written, read and judged.

brep_audit     Judges one-faced Breps from their bytes alone, before they reach a file.
brep_layout    Where the numbers of a one-faced Brep stand in its stream: parsed from the
               bytes alone.
brep_shell     All panels joined into one Brep: neighbours share their edges and vertices.
chunks         Streams of openNURBS objects: chunks with checksums, laid out once and filled
               for many objects.
cursor         Reads the stream of an openNURBS object and notes where numbers and checksums
               stand.
mesh_audit     Judges the render meshes inside Breps from their bytes alone.
panel_breps    Exact trimmed spherical faces as openNURBS objects, written byte by byte.
render_meshes  Render meshes of panels and beams as openNURBS objects, for viewers that cannot
               mesh solids.
"""
