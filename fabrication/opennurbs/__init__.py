"""The byte stream of .3dm files (openNURBS): exact Breps and render meshes.

What rhino3dm cannot build is written here byte by byte. `stream_writer` lays out bytes once
per layout and fills them for many objects. Render meshes are float32 as Rhino's own, unless
the site is so far from the origin that it would show. `stream_reader` knows nothing of who
wrote what it reads, and the audits judge what it found.

brep_audit         Judges Breps from their bytes alone, before they reach a file.
brep_evaluation    Points and volumes of Breps, evaluated from bytes.
brep_layout        Where the numbers of a Brep stand in its stream.
brep_reader        Reads Breps from their bytes, and finds the Breps of a file.
brep_writer        Writes the outer faces of panels as Breps: exact trimmed spheres.
mesh_ngons         Meshes with ngons, read and given to meshes without.
render_mesh_audit  Judges the render meshes inside Breps from their bytes alone.
render_meshes      Writes render meshes of panels for viewers that mesh no Breps.
shell_writer       Writes all panels joined into one Brep.
solid_charts       Faces of solids as exact surfaces, their edges as exact trims.
solid_writer       Writes solids as Breps: panels of a thickness, beams, node cylinders.
sphere_patches     Spherical panels as exact rational patches and trims.
stream_codes       Types of chunks, ids of classes, checksums.
stream_reader      Reads a stream of chunks.
stream_writer      Writes a stream of chunks, laid out once and filled for many objects.
"""
