"""Support structures: node axes, torsion, and the flat annuli between them (Sec. 4.1).

annuli                Annuli: flat beams, bounded by two circular arcs and the lines of their
                      ends.
annulus_checks        What keeps an annulus from being made: planes that lie flat, ends that
                      lean or cross.
annulus_construction  Finding the annuli of a sphere mesh: planes, circles, ends, and what
                      cannot be made.
beam_tilt             Tilt of the beams that lie in the planes where neighbouring spheres meet.
node_axes             Support structures: the axes of nodes, and whether the beams that meet
                      there share them.
rim_axes              Node axes along the boundary: where one plane is given at a node, and
                      edges ask for more.
"""
