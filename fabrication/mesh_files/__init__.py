"""Mesh files in and out.

file_bytes       Bytes of regular files; UTF-16, packed files and wrong suffixes by name.
groups           Groups and objects of OBJ files by name, several at once.
library_process  Reads with meshio or trimesh, in a process of its own.
mending          The end of every reader: weld, leave out slivers, say what is doubtful.
obj              Wavefront OBJ: polygons of any degree, groups, vertices counted from 1.
off              Object File Format (OFF): polygons of any degree, vertices counted from 0.
other_formats    VTK, Gmsh, Nastran, glTF and others, through meshio and trimesh.
ply              Polygon File Format (PLY): ascii or binary, polygons of any degree.
reader           Reads a file of any of these formats, or a Rhino .3dm.
stl              STL: separate triangles, ascii or binary with float32 coordinates.
surface_files    Surfaces of a .3dm with their exact normals and curvatures.
writer           Writes them.

A reader gives a `FileContent`: polygons as they are meant, and remarks on what was mended, left
out or is doubtful, which the node `read_mesh` hands on as warnings. Nothing is guessed: where a
format says how much there is, a file that holds less is refused; where it does not (OBJ), a
last line without an end and vertices without faces are said.
"""
