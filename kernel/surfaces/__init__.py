"""Surfaces to start from: exactly circular nets, triangulated samples, NURBS.

circular_nets  Exactly circular nets to start from: every face has a circumcircle.
nurbs          NURBS surfaces: exact points, derivatives and principal curvatures.
triangulated   Triangulated sample surfaces with exact normals, to remesh and to measure with.
"""
