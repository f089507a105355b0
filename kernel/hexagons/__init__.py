"""
Hexagonal sphere meshes, dual to triangulations (Sec. 7).

axis_tilt     Energy E_ortho: node axes near the normals of a surface.
delaunay      Edge flips that make the faces of a dual sphere mesh convex.
dual_meshes   Sphere meshes dual to triangulations: a face for every vertex, three spheres
              meet in a corner.
evolution     Tangent spheres that grow towards the curvature spheres of a surface.
face_shapes   Shapes of the faces of a sphere mesh: visually convex, bow-tie, or crossing
              themselves.
offsets       Offsets of tangent spheres: on which side, how large they may be, how fast they
              may vary.
shifted_rows  Triangulations of quadrilateral grids whose rows are shifted by half a step.
triples       Where three spheres meet: two points, mirror images in the plane of the centres.
"""
