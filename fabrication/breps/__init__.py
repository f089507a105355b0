"""Solids of panels, beams and nodes as boundary representations, for every writer of solids.

Every part is described once, exactly and about its own origin: STEP, Rhino files and IFC differ
in how they spell it.

beam_geometry   Corners, faces, circles and cuts of beams.
beams           Beams as solids.
measures        Volume, area and centre of mass, from their own numbers.
nodes           Cylinders about node axes as solids.
panel_geometry  Places, tolerances and axes of panels.
panels          Panels as solids, or as faces without thickness.
records         Corners, edges, faces and loops of many parts of one topology.
"""
