"""
STEP files (ISO 10303-21), written as text and checked without a CAD kernel.

assembly      Named, layered and coloured bodies in a STEP file: assemblies of parts.
beam_bodies   Beams as solids of STEP files: planes, cylinders, lines, circles and ellipses,
              all exact.
bodies        Solids, surfaces and lines as entities of STEP files (ISO 10303-21), text
              without a CAD kernel.
check         A structural check of STEP files (ISO 10303-21) that needs no CAD kernel.
node_bodies   Cylinders about node axes, and the axes, as bodies of STEP files.
panel_bodies  Panels as bodies of STEP files: spheres, planes, circles and lines, all exact.
values        Numbers, strings and references in the text of STEP files (ISO 10303-21).
writer        Panels and beams as exact CAD geometry: STEP files, and objects for CadQuery.
"""
