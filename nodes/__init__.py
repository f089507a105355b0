"""Typed functions as nodes, and the lazy graph that runs them."""
