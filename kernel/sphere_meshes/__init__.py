"""Meshes with a sphere for every face: fit, central spheres, changes of model (Sec. 3, 5, 6.1).

sphere_mesh            The sphere mesh, its vertex errors and the angles between its spheres.
fit                    Spheres to start from: face planes, and least squares.
central_spheres        Discrete central and principal spheres of circular meshes.
smoothed_spheres       Spheres through the circles of faces and smoothed apexes (Fig. 11).
mobius                 Möbius maps of meshes and sphere meshes.
model_change           Sphere meshes from planar ones: the change of model δ, sphere bundles.
support_type           The sphere ω to which all spheres of a mesh are orthogonal (Prop. 5.2).
planarity_circularity  How flat and how circular the faces of a mesh are.
"""
