"""Flat drawings in millimetres.

beams   Cutting drawings of beams as DXF: exact contours, nested on sheets.
dxf     DXF documents in millimetres, without dates and random identifiers.
moulds  Drawings of moulds as DXF or SVG: every panel in its blank, seen along its axis.
"""
