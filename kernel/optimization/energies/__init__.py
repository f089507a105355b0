"""The terms of energy (6), a file each.

A new term is one file with `blocks` (what a residual depends on), `residuals`, `jacobian` and
`second_derivatives`, its name in `table.TERMS`, and one weight in `EnergyWeights`. No column
is counted by hand: `solvers.block_patterns` builds the pattern of the Hessian once from the
blocks. The tests hold every term of the table to differences on triangles, quads and hexagons,
planes included.

- E_unit and E_dual are kept by the moves of `descent`: they are zero always, and stay in the
  table for what they say.
- E_angle is the paper's with ``g |g|`` for ``g²``: a spike costs, and 120 degrees are not
  taken for 60.
- All terms are linear, bilinear or trilinear in the unknowns, E_angle a square of such, so
  their second derivatives are small tables and exact.
- A quad whose corners lie on no circle fixes its sphere. If all quads of a mesh twist the same
  way, displacements cannot help: over any block of quads the twists add up to a difference of
  four corners. So `whole_energy.optimize_spheres` compares with flat panels, and where common
  vertices would be rougher, spheres pass within the tolerance of vertices that stay.

Terms:

sphericity  E_sphere: every vertex lies on the spheres of its faces.
unit_norm   E_unit: every row has norm one.
angle       E_angle: neighbouring spheres meet at the target angle.
regularity  E_reg: the planes in which neighbouring spheres meet stand upright on the surface.
support     E_supp: the centres of the spheres around a node lie in a plane: it has an axis.
dual_norm   E_dual: dual normals have length one.
fairness    E_fair: every interior vertex lies near the mean of its neighbours.
closeness   E_close: vertices stay where they were.

Around them:

table               The table of terms and their weights.
setting             What stays fixed, and the unknowns.
centers             The line of centres of two spheres, without dividing by a curvature.
second_derivatives  What a term adds to the Hessian.
"""
