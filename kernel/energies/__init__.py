"""The terms of energy (6) and their table."""
