"""Beams: annuli of a thickness, cut at their nodes, and what is known of them.

beams           Beams: annuli of a thickness, cut at the nodes so that neighbours do not run
                into each other.
centroids       Centres of mass of beams.
contours        Flat contours of beams, for cutting: two arcs and two lines in a plane.
cutting         Cutting beams out of annuli: mitres between neighbours, or square ends before
                a node cylinder.
drilling        Drilling marks: where beams are bolted at their nodes, along the lines of
                their ends.
end_edges       Edges across the thickness of beams: where the planes of their ends cut
                cylinders.
facts           What is to be known of every beam: for schedules, drawings, files and audits.
layers          Beams under panels: how far below them their upper edges must lie.
node_radius     Least radius of node cylinders, before which beams end clear of each other.
node_cylinders  Node cylinders: the solids at which square cut beams end, about the node axes.
triangles       Triangles of beams and cylinders for viewers: exact points and normals, flat
                between.
"""
