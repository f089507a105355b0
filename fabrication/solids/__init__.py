"""
Panels and beams as solids of CadQuery and OpenCASCADE, and the numbers they are made of.

beam_numbers   What solids of beams are made of in numbers, for OpenCASCADE and for STEP files
               alike.
beam_shapes    Beams as solids of OpenCASCADE: planes, cylinders, lines, circles and ellipses,
               all exact.
panel_numbers  What shapes of panels are made of in numbers, for OpenCASCADE and for STEP
               files alike.
panel_shapes   Panels as shapes of the CAD kernel OpenCASCADE: spheres, planes, circles and
               lines, all exact.
shape_parts    Parts of OpenCASCADE shapes: vertices, edges, faces and solids, built directly
               and shared.
"""
