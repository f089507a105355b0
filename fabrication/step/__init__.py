"""STEP files (ISO 10303-21), written as text and checked without a CAD kernel.

assembly      Bodies with names, layers and colours: assemblies of parts.
beam_bodies   Beams as solids: planes, cylinders, lines, circles and ellipses, all exact.
bodies        Solids, surfaces and lines as entities.
check         A check of the structure of a file.
node_bodies   Cylinders about node axes as solids.
panel_bodies  Panels as faces or solids: spheres, planes, circles and lines, all exact.
values        Numbers, strings and references.
writer        Writes a file of panels and beams.
"""
