"""Exact geometry in the files that fabricators open.

`files` is the only way to write: beside the target, then renamed; `folders` does it for all
files of a job, so a failed one leaves nothing behind. A killed process leaves each file old or
new, never half; the next that writes there moves what was whole and did not come to move, and
removes after a day what else was left.
Facts of parts are measured once, in the kernel; schedule, audit, user text and drawings read
them.

mesh_files  OBJ, OFF, PLY and STL, written and read; Rhino files and others as meshes.
rhino       Rhino .3dm files: meshes and surfaces read, meshes written.
rhino_models  Rhino .3dm files of panels and beams: solids, layers, user text.
rhino_objects  Single objects of Rhino in JSON, as Grasshopper sends and takes them.
opennurbs   The byte stream of .3dm files: exact Breps and render meshes.
breps       Solids of panels, beams and nodes as boundary representations: what all files of
            solids write.
ifc         IFC4 files as text: building models of panels and beams.
step        STEP files as text, and a check of that text.
drawings    Flat drawings: beams for cutting, moulds with their blanks.
schedules   Lists of parts with all that a workshop asks for.
costs       What parts cost by the prices of a workshop.
audit       Numbered findings before files go out.
solids      The same parts as shapes of OpenCASCADE and CadQuery.
objects     Meshes, panels and beams as objects of trimesh, pyvista and CadQuery.
model       What every writer writes, and what it gives back.
output_folder  The folder of a job: nothing of the user's is overwritten there.
folders     Files of a job that move into their folder together, one job at a time.
dates       The date in files, which is not the clock's.
files       Files written whole or not at all.
locks       Files that one process holds against others.
measures    What is measured of parts once, for all files of a job that say it.
units       Units of length: the only place that knows what a millimetre is.
sizes       How large a model is in its units, and whether a building can be so.
polygons    What a mesh file says, before it is known to be a mesh.
triangles   Triangles for the formats that have nothing else.
text        Text files of numbers: lines, words, and errors that name the line.
tables      Tables of plain values as CSV and XLSX.
"""
