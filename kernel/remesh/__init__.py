"""Quadrilateral sphere meshes from congruences of spheres (Sec. 6.4)."""
