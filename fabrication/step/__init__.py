"""STEP files (ISO 10303-21), written as text and checked without a CAD kernel.

OpenCASCADE would write the same eight times as slowly. `bodies` lays out the entities of
bodies of one topology once and fills them with numbers, both from `fabrication.breps`;
`assembly` is the tree of groups and parts around them, where a part may stand in several
places. OpenCASCADE repairs what it reads, so `check` judges the text of files without it.

assembly            Bodies with names, layers and colours: assemblies of parts.
bodies              Solids, surfaces and lines as entities.
check               A check of the structure of a file.
digits              How many digits of numbers are written.
opencascade_writer  Assemblies of CadQuery as files, by OpenCASCADE.
parameter_curves    Arcs in the parameters of their spheres, where readers need them.
sharing             What the curves and surfaces of a part have in common.
values              Numbers, strings and references.
writer              Writes a file of panels and beams.
"""
