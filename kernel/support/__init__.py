"""Support structures: node axes, torsion, and the flat annuli between them (Sec. 4.1).

annuli                Annuli: flat beams, bounded by two circular arcs and the lines of their
                      ends.
annulus_checks        What keeps an annulus from being made: planes that lie flat, ends that
                      lean or cross.
annulus_construction  Annuli of a depth or a power, and what cannot be made.
beam_axes             Node axes between which beams are flat: the axis problem.
beam_supports         Supports whose beams stand in the walls of the panels: on node axes, or
                      upright.
beam_tilt             Tilt of the beams that lie in the planes where neighbouring spheres meet.
clear_joints          Joints of panels on beams: wide enough that panels clear each other at
                      the nodes.
feasibility           Whether a mesh can have beams on node axes, found before anything is
                      optimised.
node_axes             Support structures: the axes of nodes, and whether the beams that meet
                      there share them.
outer_annuli          Planes and outer circles of annuli, before their inner side is found.
rim_axes              Node axes along the boundary: where one plane is given at a node, and
                      edges ask for more.
"""
