"""Writes Rhino .3dm models of panels and beams: the solids of STEP files, layers, user text.

rhino3dm writes what stands once in a file, `archive` the objects, byte by byte; then rhino3dm
reads the whole file back, and every object must be there and valid.

archive       Objects of a file as records: attributes, user text, streams.
beam_writer   Writes beams: solids, drilling marks, nodes.
block_writer  Writes blocks: one piece of geometry, set into the model many times.
model         A model under construction: layers, materials, groups, views, ids.
panel_writer  Writes panels: exact faces or solids, edges as arcs, user text.
solids        Panels, beams and node cylinders as streams of Breps.
to_check      Marks what was found: parts that are to be checked, and those that are missing.
writer        Writes a file of panels and beams.
"""
