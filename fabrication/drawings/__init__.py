"""Flat drawings in millimetres.

beam_sheets   Sheets of beams: every shape in its plane, with its measures and end cuts.
beams         Cutting drawings of beams as DXF: exact contours, nested on sheets.
drawing       What is drawn: lines with arcs, circles and texts on layers.
drawing_set   A set of drawings: key plans, sheets of panels by moulds, sheets of beams.
dxf           DXF as text, set into an empty document.
key_plan      Key plans: where every panel, beam and node of the drawings is.
moulds        Drawings of moulds as DXF or SVG: every panel in its blank.
moves         Drawing of the design: how far an optimisation moved its vertices.
nesting       Rectangles on stock sheets, as few as a short search finds.
outlines      Outlines of panels as they are seen along an axis: circular arcs on paper.
pages         Pages of paper: sizes, frames, title blocks, all pages in one drawing.
panel_sheets  Sheets of panels, by moulds: every panel seen from outside, with measures.
pdf           PDF pages: arcs as curves, texts as text.
stock_sheets  Parts of a model as rectangles on stock sheets.
svg           SVG as text, for browsers and print.
"""
