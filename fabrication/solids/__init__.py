"""Solids of panels and beams: their geometry in numbers, and as objects of CAD kernels.

cadquery_assembly   Panels and beams as assemblies of CadQuery.
opencascade_beams   Beams as solids of OpenCASCADE, all exact.
opencascade_panels  Panels as faces or solids of OpenCASCADE, all exact.
opencascade_parts   Vertices, edges, faces and solids of OpenCASCADE, built directly and shared.
"""
