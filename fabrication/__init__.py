"""Exact geometry in the files that fabricators open."""
