"""
Planarisation: nodes whose spheres share two points, so that beams have no torsion.

held_nets         Planar nodes that stay near: on the surface that a net was made on, or where
                  they are.
node_elimination  Elimination of the nodes from a damped Gauss-Newton step, without losing
                  what is left.
node_sites        Where nodes may be: on a surface, and those of its boundary on the boundary.
planarize         Planarisation: sphere meshes whose nodes are free of torsion.
step_norm         How large a step of a planarisation is: changes as shares of what changes.
steps             Gauss-Newton steps towards planar nodes, by elimination of the nodes.
system            Least squares for planar nodes: unknowns, residuals and their derivatives.
turned_neighbors  Neighbours on all but the same sphere, turned apart so that a beam knows its
                  plane.
"""
