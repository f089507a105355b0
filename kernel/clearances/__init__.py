"""How near parts are to each other, and how far they overlap.

bodies          Panels, beams and node cylinders as intersections of what single faces bound.
near_pairs      Pairs of bodies whose boxes are near: by a grid, none is missed.
interior_point  Many small convex-like programs at once, by a primal-dual interior point method.
overlaps        How deep bodies overlap, and how far apart they are.
"""
