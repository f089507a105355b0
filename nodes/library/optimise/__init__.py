"""Spheres that meet smoothly, at a given angle, or along strips.

angles    Spheres that meet their neighbours smoothly, or at a given angle.
energy    Spheres, and vertices where they may move, of the least energy.
outcomes  What an optimum came to, against flat panels.
strips    Spheres that are smooth along strips.
"""
