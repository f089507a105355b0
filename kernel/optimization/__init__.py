"""Spheres that meet smoothly, in few radii: angles, energy (6), strips, clusters.

Meshes with Spherical Faces, Secs. 3, 4 and 6.3.

Angles alone, on vertices that stay, are the smallest problem: all spheres through the circle
of a face are ``cos t P + sin t Q``, one unknown per face and four numbers per edge.
Stage 1 minimises the signed energy ``Σ (1 - g)``, which tells smooth contact from a spike;
stage 2 the paper's ``Σ (g² - 1)²`` from there. Both are Newton iterations on an F×F system with
one entry per edge. The start is the smoother of the given spheres and the face planes, so any
start gives the same result. Another density is a function of g with two derivatives.

A target angle has many optima, and saddles between them. Six starts of structure (two colours
of the faces, about smooth contact and about the planes, and continuation, each either way) end
at optima of second order: at rest the signs of the pivots of the Hessian are looked at, and a
descent leaves a saddle along the lowest eigenvector. Of each part the lowest end counts, and of
equal ones the one that bulges more, so the numbering decides nothing. Creases weigh nothing,
the openings of caps are bounded (projected Newton), and no part is handed over rougher than
its planes.

Everything else, moving vertices, upright planes and nodes with axes, is `whole_energy`, by the
Newton method in `descent` on the terms in `energies`.

angle_minimization  Angles in the pencils of the faces' circles, vertices fixed.
pencil_energy       Energies of the angles between neighbours, one unknown per face.
pencil_newton       Newton's method for them: bounds, negative curvature, saddles left.
target_starts       Where to start when neighbours shall meet at an angle.
strips              Rows of faces whose spheres join smoothly along the row, and only there.
pieces              Separate pieces of a mesh, each measured by itself.
radius_clustering   Few moulds: the radii of a sphere mesh gathered into clusters.
flat_panels         Panels that bulge less than an eye can tell, as planes.
line_clusters       Clusters of numbers on a line with the least sum of squares, exactly.
comparison          Is an optimum better than doing nothing?
whole_energy        Energy (6): smooth spheres, upright planes between them, nodes with axes.
costs               What it will take, said beforehand where it is much.
energies            The terms of energy (6) and their table.
descent             How their sum falls, and what has to hold.
"""
