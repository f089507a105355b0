"""
Spheres that meet smoothly, in few radii: angles, energy (6), strips, clusters (Sec. 3, 4, 6.3).

clustering    Few moulds: the radii of a sphere mesh gathered into clusters.
energies      The terms of energy (6) and their table.
pencil        Angle minimisation in the pencils of the faces' circles.
strips        Strips: rows of faces whose spheres join smoothly along the row, and only there.
whole_energy  Energy (6) on sphere meshes: smooth spheres, upright planes between them, nodes
              with axes.
"""
