"""The nodes, one module per category."""
