"""Spheres, circles and arcs as rows of numbers, and the Möbius group (Sec. 2.1).

A sphere is a row ``(A, Bx, By, Bz, C)``: the points x with ``A |x|² - B·x + C = 0``. Planes are
the rows with A = 0 (B the normal, C the offset of ``n·x = d``) and are never a special case;
nothing divides by A on the way to a result. A row is *unit* where ``|B|² - 4 A C = 1``.

The sign of a row is its orientation: ``N(p) = B - 2 A p`` is the unit normal at a point p of a
unit row, and 2A the curvature with respect to N (centre ``p + N / 2A``). On a sphere mesh N
agrees with the normal of the face, so A > 0 bulges inwards and A < 0 outwards.

The Minkowski product ``<<s, t>> = B·B' - 2 (A C' + A' C)`` of two unit rows is the cosine of
the angle between their normals at a common point: +1 is smooth contact, -1 a spike.

rows             Rows of spheres, planes and points: making, kind, origin, scale, offset.
row_checks       Rows that users give: checked, seen from points, and made unit.
minkowski        The Minkowski product, and the angle at which spheres meet.
incidence        Points and lines against spheres: distances, normals, feet, crossings.
circles          Circles: intersections of spheres, through points, and their pencils.
arcs             Circular arcs on spheres, and what is bounded by them.
arc_crossings    Whether the boundary of a face on a sphere crosses itself: exact tests.
pentaspherical   Pentaspherical coordinates, stereographic images and poles.
mobius_group     Möbius transforms: similarity, inversion, composition, inverse.
mobius_images    Images of points, spheres, circles and arcs under Möbius maps.
mobius_local     Möbius maps near a point: the form that loses no digits.
mobius_matrices  Möbius maps and their Lorentz matrices, each made from the other.
"""
