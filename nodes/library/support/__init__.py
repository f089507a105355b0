"""Nodes and beams that carry the panels.

beams      Beams of annuli, and the marks for drilling them.
exact      Nets with exact supports.
rejected   Parts that cannot be made, named in a warning.
structure  Nodes where spheres meet, and the annuli between them.
"""
