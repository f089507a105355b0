"""Solvers of least-squares problems and of the linear systems in them."""
