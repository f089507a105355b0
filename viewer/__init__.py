"""Pictures of sphere meshes and panels, and a page on which they turn.

assembly  Pictures of panels on their beams: from below, or near a node.
page      A model as one HTML file that turns, shines and answers in any browser.
render    Pictures of panels without graphics hardware.
scene     What is seen in the samples of a picture: the exact point, normal and joint.
raster    Which triangle is seen in each pixel: scanlines and a depth buffer, in arrays.
camera    Where a picture is taken from, and what of the scene lies where in it.
light      Daylight: a bright sky, and a sun with a soft edge.
"""
