"""The byte stream of .3dm files (openNURBS): exact Breps and render meshes.

brep_audit         Judges one-faced Breps from their bytes alone, before they reach a file.
brep_evaluation    Points of the trims, edges and surfaces of Breps, evaluated from bytes.
brep_layout        Where the numbers of a one-faced Brep stand in its stream.
brep_reader        Reads one-faced Breps from their bytes, and finds the Breps of a file.
brep_writer        Writes the outer faces of panels as Breps: exact trimmed spheres.
mesh_ngons         Meshes with ngons, read and given to meshes without.
render_mesh_audit  Judges the render meshes inside Breps from their bytes alone.
render_meshes      Writes render meshes of panels and beams for viewers that mesh no solids.
shell_writer       Writes all panels joined into one Brep.
sphere_patches     Spherical panels as exact rational patches and trims.
stream_codes       Types of chunks, ids of classes, checksums.
stream_reader      Reads a stream of chunks.
stream_writer      Writes a stream of chunks, laid out once and filled for many objects.
"""
