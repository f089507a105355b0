"""
The terms of energy (6) and their table.

angle       E_angle: neighbouring spheres meet at the target angle.
centers     The line of centres of two spheres, without dividing by a curvature.
closeness   E_close: vertices stay where they were.
dual_norm   E_dual: dual normals have length one. Steps are normalised: its value is rounding
            alone.
fairness    E_fair: every interior vertex lies near the mean of its neighbours.
freedom     Which way the unknowns may move.
minimize    Minimising energy (6): from a setting and weights to the best unknowns.
regularity  E_reg: the planes in which neighbouring spheres meet stand upright on the surface.
setting     What an energy of sphere meshes is made of: what stays fixed, and the unknowns.
sphericity  E_sphere: every vertex lies on the spheres of its faces.
support     E_supp: the centres of the spheres around a node lie in a plane, so the node has
            an axis.
table       The table of terms of energy (6).
unit_norm   E_unit: every row has norm one. Steps are normalised, so its value is rounding
            alone.
"""
