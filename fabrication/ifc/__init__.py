"""IFC4 files: a curtain wall of plates and members, as text and without a library.

IFC is written in the syntax of STEP, and its solids are those of STEP files under other names:
a file of thousands of parts takes seconds. IfcOpenShell, which would take minutes to write it,
reads and judges it in the tests.

bodies      Solids and surfaces of STEP files as IFC spells them, and triangles.
entities    Numbered entities, names of their own for all that is rooted.
patches     Pieces of spheres as spline surfaces, rational or polynomials.
properties  Property sets and quantities of panels and beams.
triangles   Closed triangulations for programs that have no spheres.
writer      Writes a file of panels and beams.
"""
