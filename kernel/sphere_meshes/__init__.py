"""
Meshes with a sphere for every face: fit, central spheres, maps, models (Sec. 3, 5, 6.1).

central       Central and principal spheres of circular meshes, and spheres from smoothing.
fit           Spheres for the faces of a mesh to start from: planes, and least squares.
mobius_maps   Möbius maps at work: on points, spheres, circles, arcs, meshes and sphere
              meshes.
model_change  Sphere meshes from planar ones, by changing the model of a geometry.
planarity     How flat and how circular the faces of a mesh are.
sphere_mesh   The sphere mesh: a mesh with a sphere for every face.
support_type  The sphere ω to which all spheres of a mesh are orthogonal, and what kind of
              sphere it is.
"""
