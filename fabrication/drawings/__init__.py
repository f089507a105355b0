"""Flat drawings in millimetres.

beams     Cutting drawings of beams as DXF: exact contours, nested on sheets.
drawing   What is drawn: lines with arcs, circles and texts on layers.
dxf       DXF as text, set into an empty document.
moulds    Drawings of moulds as DXF or SVG: every panel in its blank, seen along its axis.
outlines  Outlines of panels as they are seen along an axis: circular arcs on paper.
svg       SVG as text, for browsers and print.
"""
