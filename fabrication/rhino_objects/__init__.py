"""Single objects of Rhino in JSON, as Grasshopper and Rhino's programs exchange them.

An object is the four entries of `Encode` and `ToJSON`: the versions that its stream goes with,
and the stream in base64. What can be is written and read as bytes, without rhino3dm.

curves    Arcs, lines and circles, written and read.
fields    The four entries of an object, and its stream.
meshes    Meshes with ngons, written and read.
solids    Writes panels, beams and node cylinders as exact Breps.
surfaces  Reads surfaces and polysurfaces with their normals and curvatures.
"""
