"""Many results from one graph: sliders moved over ranges, here or on many machines.

sweep  Results for all combinations of slider values.
"""
