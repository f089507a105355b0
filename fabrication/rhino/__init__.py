"""Rhino .3dm files: writing a model, and reading meshes and surfaces.

beam_writer     Writes beams: capped extrusions of their contours, drilling marks, nodes.
brep_faces      Reads the faces of polysurfaces with their trims, as records of the kernel.
block_writer    Writes blocks: one piece of geometry, set into the model many times.
curves          Arcs, lines and circles as curves.
isolation       Runs a function in a process of its own, with limits on time and memory.
layers          Layers: which are on, and which a user means.
mesh_writer     Writes meshes; faces with more than four corners are ngons.
model           A model under construction: layers, materials, groups, views, ids.
object_polygons  Reads all that can be panelled, object by object, and says what cannot.
object_reader   Reads objects where they stand, those inside blocks included.
panel_writer    Writes panels: exact trimmed spheres, edges as arcs, user text.
reader          Reads a file: meshes with ngons, or grids on surfaces.
surface_reader  Reads surfaces and polysurfaces as meshes with vertices exactly on them.
surface_shapes  Reads surfaces as a mesh with their exact normals and curvatures.
writer          Writes a file of panels and beams.
"""
