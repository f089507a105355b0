"""Two-parameter families of spheres and their envelopes (Sec. 2.2, 2.3).

curvature_spheres   Spheres that touch a surface: tangent, principal and central ones.
smooth_envelopes    The two envelopes of a smooth congruence, from its first derivatives.
discrete_envelopes  Envelopes of discrete congruences, mirror points, contact points, Ribaucour.
conjugacy           How far parametrisations and nets are from conjugate.
"""
