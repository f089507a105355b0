"""
Rhino .3dm files: the model that is written, and what is read.

beams     Beams for a Rhino model: capped extrusions of their flat contours, drilling marks,
          and nodes.
blocks    Block definitions of Rhino: one piece of geometry, set into the model many times.
meshes    Meshes with ngons, and grids on surfaces, in Rhino .3dm files.
model     A Rhino model under construction: layers, materials, groups, views, and ids.
objects   Objects of a Rhino model where they stand, those inside blocks included.
surfaces  Surfaces and polysurfaces of a Rhino file as grids of quads with exact positions.
writer    Panels as a Rhino model: exact trimmed spheres, edges as arcs, and what a workshop
          must know.
"""
