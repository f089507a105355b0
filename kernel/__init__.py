"""Pure functions on arrays and frozen records: the mathematics."""
