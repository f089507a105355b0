"""From a design surface to a pattern of panels: what spheres gain, and quads that are built.

A net of spheres of one curvature K that touch a surface follows its lines of curvature,
whatever K is. Neighbours along the direction i meet at about ``|K - k_i| E`` (E the edge,
flat panels have K = 0), so the median of all k1 and k2 is the best K, and what spheres gain
is known before anything is remeshed. Nets are badly conditioned along the lines ``K = k_i``:
a short list of K is tried, and each net judged as a workshop would.

curved_refinement   Coarse meshes as the smooth surfaces that they stand for.
density             Edges that are shorter where a surface bends more.
deviations          How far a net is from its surface, and the surface from the net.
dual_patterns       Even triangles on a surface, and the convex hexagons dual to them.
expected_angles     Angles between neighbours that the curvatures of a surface foretell.
gain_report         What spheres gain in each pattern, in numbers and in a sentence.
held_nets           Nets planarised on their surface, the most faithful first.
net_flaws           What keeps a net from being built, by face and cause.
panel_scale         A surface as panels of a size see it: curvatures, convex spheres.
polishing           Hexagons without slivers: vertices slide until no dual edge is short.
quad_pattern        The short list of curvatures: remesh, planarise, judge, keep the best.
scales              A pattern with four times the faces, or a quarter.
semiregular         Triangles or quads with corners cut, or drawn apart.
surface_curvatures  Principal curvatures of a mesh or surface, and the area each stands for.
"""
