"""Exact geometry in the files that fabricators open.

`files` is the only way to write: beside the target, then renamed; `replacing_all` does it for
a folder, so a failed job leaves nothing behind. A killed process leaves each file old or new,
never half, and what it leaves besides is removed after a day by the next that writes there.
Facts of parts are measured once, in the kernel; schedule, audit, user text and drawings read
them.

mesh_files  OBJ, OFF, PLY and STL, written and read; Rhino files and others as meshes.
rhino       Rhino .3dm files: meshes and surfaces read, meshes written.
rhino_models  Rhino .3dm files of panels and beams: solids, layers, user text.
rhino_objects  Single objects of Rhino in JSON, as Grasshopper sends and takes them.
opennurbs   The byte stream of .3dm files: exact Breps and render meshes.
breps       Solids of panels, beams and nodes as boundary representations: what all files of
            solids write.
step        STEP files as text, and a check of that text.
drawings    Flat drawings: beams for cutting, moulds with their blanks.
schedules   Lists of parts with all that a workshop asks for.
costs       What parts cost by the prices of a workshop.
audit       Numbered findings before files go out.
solids      The same parts as shapes of OpenCASCADE and CadQuery.
model       What every writer writes, and what it gives back.
output_folder  The folder of a job: nothing of the user's is overwritten there.
files       Files written whole or not at all.
units       Units of length: the only place that knows what a millimetre is.
sizes       How large a model is in its units, and whether a building can be so.
polygons    What a mesh file says, before it is known to be a mesh.
triangles   Triangles for the formats that have nothing else.
text        Text files of numbers: lines, words, and errors that name the line.
tables      Tables of plain values as CSV and XLSX.
"""
