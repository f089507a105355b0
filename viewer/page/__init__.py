"""The page: a model as one HTML file that turns, shines and answers in any browser.

The browser's side is written in `source/` (see its README) and bundled once into `bundle/`;
here is what a page is filled with.

beams      Beams and node cylinders as a page draws them: corners, rises and axes.
container  Named arrays and a head as bytes, compact once compressed.
document   The page itself: one file of text that asks for nothing else.
faces      Faces of panels as a page draws them: points by row, triangles by pattern.
grid       Coordinates of a page: whole steps from the middle of the model.
missing    Parts that cannot be made: why, where they would be, and what is beside them.
sky        How much light of the sky arrives at the points of panels.
"""
