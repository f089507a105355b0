"""Planarisation: nodes whose spheres share two points, so that beams have no torsion.

Solved is a least-squares problem. A node is planar if the rows ``(a A, N)`` of its spheres,
seen from it, have a common normal in R⁴. Unknowns are the rows of the spheres and, for each
node, 7 numbers: its point and that normal; there is no gauge. Levenberg-Marquardt has the
conditions alone for energy. Closeness and fairness are the norm of its damping, so steps are
least in it and no compromise is left at the end. Weighted into the energy they made spheres of
short edges fall into one; so does a plain norm, because a node with two equal spheres is
planar too. The norm therefore measures changes as shares: of the difference of two neighbours,
of the shortest edge of a node. From each step the nodes are eliminated by the singular values
of their derivatives. Inverses of their normal matrices would leave steps to rounding along
ways that the conditions leave open: the same roof in feet would come out a micrometre off.

A net can be held on the surface that it was made on: one more condition per node, of seven
unknowns and five conditions. On the boundary that is one too many where lines end askew: only
the first two steps count it there, as heavily as edges at the boundary survive it. What moves
nodes there is lines that leave the directions: `ACROSS` in `map.coordinate` at 100 instead of
30 halves that. Nodes of the boundary are planarised where three beams or more meet.

The same method lands the nodes of an optimised support. An optimum leaves spheres that miss
vertices by a thousandth of an edge, and then circles around a node share no line even where
their planes are parallel to one. The plane of two spheres that meet at a millionth is not
known to a billionth: such neighbours are turned apart first. Beams judge the result, not the
conditions: planes that pass for spheres of a billion edges fulfil them.

Read in this order:

conditions      The conditions: unknowns, residuals and derivatives, and where nodes may lie.
steps           Gauss-Newton steps: the norm of the damping, and the elimination of the nodes.
planarize       The descent: `planarize`, and `planarize_held` on a surface.
landing         `planarize_near` for optimised supports: the least move, alike neighbours apart.
node_planarity  Measures of nodes: planarity in P⁴, node axes, real common points.
"""
