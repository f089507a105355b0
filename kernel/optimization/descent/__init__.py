"""How energy (6) falls: Newton's method on the terms of `energies`, with what has to hold.

- Unit rows, unit dual normals and given radii are kept by the moves themselves. A step has only
  the directions that they leave (4 of a row, 3 with a given radius, 2 of a dual normal), and
  second derivatives count how a move bends.
- What has to hold exactly (nodes with axes, vertices on their spheres) gets multipliers, round
  by round: at the end it holds to 1e-8, without weights that would make the problem stiff.
  What comes no nearer from round to round cannot hold.
- What has a limit (displacements, misses of spheres with corners of their own) costs little
  inside, and beyond all bounds towards it. As this price falls from round to round, of all
  optima the one of least displacement remains: many shapes of a smooth mesh are as good as
  equal, and without a price rounding would choose one. Node axes have a price for leaning,
  and follow the spheres: a move that changed both at once would miss by their product.
- Second derivatives matter: on smooth meshes residuals times curvatures are not small, and
  without them it takes ten times as many steps. Far from an
  optimum, where the Hessian is indefinite, its convex part leads on.

freedom      Which way the unknowns may move.
problem      The energy: its terms, what has to hold, what has limits.
axes         Node axes follow the spheres.
derivatives  Its first and second derivatives in the directions of moves.
multipliers  Descents, and the rounds in which what has to hold comes to hold.
"""
