"""
Mesh files in and out: OBJ, OFF, PLY, STL.

formats  Mesh files: polygons in and out, in the order of the file.
obj      Wavefront OBJ: polygons of any degree, groups and objects, vertices counted from 1.
off      Object File Format (OFF): polygons of any degree, vertices counted from 0.
ply      Polygon File Format (PLY): ascii or binary of either byte order, polygons of any
         degree.
stl      STL: separate triangles, ascii or binary; coordinates of binary files are float32.
"""
