"""What panels and beams cost by the prices of a workshop.

cost    The cost of panels, their moulds and blanks, of beams and nodes.
curve   Cost and smoothness over the number of moulds.
prices  Prices of a workshop, read from a file.
"""
