"""Panels: pieces of spheres cut out by planes, what is known of them, and their moulds.

centroids     Centres of mass of panels.
checks        What keeps a panel from being made: crossing boundaries, lost corners, caps too
              deep.
congruent     Identical panels: those that a rigid motion carries onto each other.
cutting       Cutting panels out of the spheres of a mesh, by one plane per edge.
edge_axes     Node axes as panels and beams use them: given as two points each, in any order.
facts         What is to be known of every panel: for schedules, drawings, files and audits.
fans          Triangles of a face by its outline: a fan about its middle, or ears.
joints        Joints between panels: steps, gaps and holes.
mould_blanks  Mould blanks: the smallest cap that holds each panel, and how many of which
              size.
mould_caps    Moulds as surfaces: the cap of each, and where the panels lie on it.
panels        Panels: pieces of spheres cut out by planes, exact each in itself.
rims          Points along the edges of panels, once for each edge that two panels share.
tessellation  Triangles for pictures and viewers: points and normals exact, only the faces
              between flat.
thickness     The two faces of a panel with a thickness: spheres concentric with its own.
"""
