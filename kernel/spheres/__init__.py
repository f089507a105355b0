"""
Spheres, circles and arcs as rows of numbers, and the Möbius group (Sec. 2.1).

arc_crossings  Whether the boundary of a face on a sphere crosses itself: exact tests of arcs.
arcs           Circular arcs on spheres, and what is bounded by them.
circles        Circles: as intersections of spheres, through points, and as carriers of
               pencils of spheres.
lorentz        Möbius maps near a point: what a Lorentz matrix is read into before it acts on
               anything.
mobius         The Möbius group: similarities, inversions, their products, and what they do to
               everything.
rows           Spheres and planes as rows, their Minkowski product, and what follows from it.
"""
