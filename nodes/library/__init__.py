"""The nodes by chapters: typed functions from meshes to files.

analyse     Numbers that tell how good a sphere mesh is.
arrays      Types of the arrays that go by wire.
cluster     Few moulds for many panels, and their blanks.
congruence  Spheres at the vertices of a surface, and the surfaces that they envelop.
fabricate   Panels, and the files that fabricators open.
fewest      The fewest moulds with which panels still meet smoothly enough.
input       Meshes to start from: read from files, or exactly circular nets.
lists       Lists as values: what steps mapped over lists give, in another form.
meshing     Other meshes of the same shape: triangulated, subdivided, remeshed, repaired.
mobius      Möbius transforms, and the coordinates on which they act.
models      Sphere meshes with a support structure by construction, and how to recognise them.
optimise    Spheres that meet smoothly, at a given angle, or along strips.
patterns    From a design surface to a pattern of panels, and what spheres will gain in it.
remesh      Nets of spheres with a support structure, along conjugate directions.
shex        Hexagonal sphere meshes: spheres that touch a triangulation.
spheres     A sphere for every face to start from, and spheres and planes one by one.
support     Nodes and beams that carry the panels.
workshop    Identical panels, findings, costs, the report, solids.
"""
