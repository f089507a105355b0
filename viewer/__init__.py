"""Pictures of sphere meshes and panels, and a page on which they turn.

assembly      Pictures of panels on their beams: from below, or near a node.
page          A model as one HTML file that turns, shines and answers in any browser.
report        What a panelling came to, as one page to read and to print.
render        Pictures of panels, beams and other things without graphics hardware.
surroundings  The ground that things stand on, with their shadows.
shading       How a surface looks in its light: paint, and what polish mirrors.
exposure      How a scene becomes pixels: which surface is seen where, and in what light.
scene         What is seen in the samples of a picture: the exact point, normal and joint.
shapes        Things to draw: panels, beams, nodes, spheres, meshes, lines and circles.
legend        Legends beside pictures.
colors        What the colours of panels mean, and the words for a legend that says so.
light         Daylight: a bright sky, and a sun with a soft edge.
raster        Which triangle is seen in each sample: scanlines and a depth buffer, in arrays.
camera        Where a picture is taken from, and what of the scene lies where in it.
"""
