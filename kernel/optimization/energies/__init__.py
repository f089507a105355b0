"""The terms of energy (6), a file each, and how their sum falls.

A new term is one file with `blocks` (what a residual depends on), `residuals` and `jacobian`,
its name in `table.TERMS`, and one weight in `EnergyWeights`. No column is counted by hand:
`solvers.blocks` builds the pattern of the Jacobian once from the blocks. The tests run every
term of the table against differences on triangles, quads and hexagons, planes included.

- Unit rows, unit dual normals, given radii and the bound on displacements are kept by the
  moves themselves (`freedom`), and derivatives are projected onto what a move leaves free.
  E_unit and E_dual are therefore zero always; they stay in the table as gauges that make the
  systems regular. Without the projection the linear model promises gains that no step
  delivers, and the descent stalls.
- E_angle is the paper's with ``g |g|`` for ``g²``: a spike costs, and 120 degrees are not
  taken for 60.
- A step minimises the damped linear model by conjugate gradients on J (``JᵀJ`` is never
  formed), preconditioned by its diagonal blocks and stopped when the model gains no more. A
  coarse grid of aggregates saves no iteration; block-tridiagonal strips save 40 % of them at
  twice the cost.
- A step that would carry vertices over the bound of their displacement is found again with
  those at the bound. Cutting them back alone tears them from their spheres: the descent then
  zigzags, and rounding decides where it ends.
- What must hold exactly (nodes with axes, vertices on their spheres) gets ten times the weight
  from stage to stage, and moving vertices finally land: the constraints alone, by
  Gauss-Newton.
- Where vertices stay, the first stage comes to rest, with steps that leave little out
  (`RESTING_MODEL`): its valley is flat, and a descent that ends halfway ends where rounding has
  led it. Raised weights make the valley steep and keep what they find. Going on until a step
  gains 1e-9 leaves saddles; all stages at rest cost noisy meshes ten times as much.
- A quad whose corners lie on no circle fixes its sphere. If all quads of a mesh twist the same
  way, displacements cannot help: over any block of quads the twists add up to a difference of
  four corners. So `whole_energy.optimize_spheres` compares with flat panels, and where common
  vertices would be rougher, spheres pass within the tolerance of vertices that stay.
- CHOLMOD (extra ``cholmod``) replaces SuperLU in the fallback, numba (extra ``fast``) SciPy's
  two products by one sweep in the same order: same results.

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

table       The table of terms and their weights.
setting     What stays fixed, and the unknowns.
centers     The line of centres of two spheres, without dividing by a curvature.
freedom     Which way the unknowns may move.
minimize    Minimising the sum: from a setting and weights to the best unknowns.
"""
