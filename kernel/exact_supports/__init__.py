"""Exact supports: nets that slide on their surface until beams and panels meet exactly.

A sphere mesh has beams without torsion and panels without gaps if all spheres of a node share
two points. For spheres that touch a surface this says ``II(u, v) = κ I(u, v)`` for the two
directions of the net: with κ far from the curvatures of the surface the net is orthogonal and
conjugate, one of curvature lines. Design meshes are near to that, but 3 to 30 degrees off. With
fixed vertices only planes are left. So vertices slide in the surface, by half an edge, and
hardly leave it; curvatures are nearly one, because an axis leans by
``tan = |∂κ| / (|κ| |κ - k|)``.

Sec. 4.1 of the paper "Meshes with Spherical Faces". Lengths are in mean edges throughout.

curvatures      The curvature that suits a surface best, and spheres of it to start from.
design_surface  The surface that a mesh stands for: heights, slides, moves across the boundary.
setting         What stays fixed, and the unknowns: rows, shifts, poles of nodes.
terms           What a term is.
conditions      What must hold to rounding: incidence, common axes, flat beams, unit rows.
wishes          What shall be small: moves, angles, lean, differences of curvature.
descent         Levenberg-Marquardt, conditions weighing more and more.
axes            The node axes of a net that has an exact support.
landing         The rest of the conditions, met to rounding.
judgement       Measures of what was found.
search          Common curvatures, one after the other; the best net.
"""
