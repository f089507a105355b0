"""Nodes and beams that carry the panels.

axis         Beams in planes of their edge and its node axes: vertices and spheres stay.
beams        Beams of annuli, and the marks for drilling them.
bisector     Upright beams for any mesh: their planes bisect the faces, cylinders take up the
             torsion.
equal_radii  Spheres of equal radii, to start a support from.
exact        Nets that slide until beams and panels meet exactly.
feasibility  Whether a mesh can have beams on node axes.
kept         Spheres that a mesh has already, with the nodes of a support in them.
picture      Pictures of panels on their beams.
rejected     Parts that cannot be made, named in a warning.
structure    Nodes where spheres meet, and the annuli between them.
"""
