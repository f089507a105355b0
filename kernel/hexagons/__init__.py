"""Hexagonal sphere meshes, dual to triangulations (Sec. 7).

dual_sphere_mesh  A face for every vertex of a triangulation; boundaries dropped or clipped.
vertex_rule       The vertices of hexagons: where three spheres meet nearest the triangle.
evolution         Tangent spheres that grow towards the curvature spheres: E_cs, E_fair.
ortho_energy      Energy E_ortho: node axes near the normals of a surface.
tangent_offsets   Offsets of tangent spheres: the side, the largest, the steepest.
delaunay_flips    Edge flips that make the faces of the dual mesh convex.
face_shapes       Faces that are visually convex, bow-ties, or cross themselves (Fig. 30, 31).
shifted_rows      Triangulations of quad grids whose rows are shifted by half a step.
"""
