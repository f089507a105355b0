"""Rhino .3dm files as meshes and surfaces, read, and meshes written.

brep_faces      Reads the faces of polysurfaces with their trims, as records of the kernel.
isolation       Runs a function in a process of its own, with limits on time and memory.
layers          Layers: which are on, and which a user means.
mesh_writer     Writes meshes; faces with more than four corners are ngons.
object_polygons  Reads all that can be panelled, object by object, and says what cannot.
object_reader   Reads objects where they stand, those inside blocks included.
reader          Reads a file: meshes with ngons, or grids on surfaces.
surface_reader  Reads surfaces and polysurfaces as meshes with vertices exactly on them.
surface_shapes  Reads surfaces as a mesh with their exact normals and curvatures.
"""
