"""Mesh files in and out.

obj     Wavefront OBJ: polygons of any degree, groups and objects, vertices counted from 1.
off     Object File Format (OFF): polygons of any degree, vertices counted from 0.
ply     Polygon File Format (PLY): ascii or binary of either byte order, polygons of any degree.
reader  Reads a file of any of these formats, or a Rhino .3dm.
stl     STL: separate triangles, ascii or binary; coordinates of binary files are float32.
surface_files  Surfaces of a .3dm with their exact normals and curvatures.
writer  Writes them.
"""
