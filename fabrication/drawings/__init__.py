"""
Flat drawings in millimetres: beams for cutting, moulds with their blanks.

beams   Cutting drawings of beams as DXF: exact contours, nested on sheets, in millimetres.
moulds  Drawings of moulds: every panel in its blank, seen along the axis of the blank, in
        millimetres.
"""
