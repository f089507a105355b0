"""
Quadrilateral sphere meshes from congruences of spheres (Sec. 6.4).

field     Conjugate directions of a congruence, as a smooth field over its mesh.
map       Seamless maps to the plane whose coordinate lines follow the field.
net       From the lines of a map to a net of nodes, edges and cells.
pipeline  From a sphere congruence to a net of spheres that can have a support structure (Sec.
          6.4).
planar    Planarisation: nodes whose spheres share two points, so that beams have no torsion.
reports   Plain reports of nets: how a congruence was remeshed, how its nodes became planar.
"""
