"""
What panels, beams and nodes are called, and what is said of them.

colors    Names and colours of moulds: the same in every file and picture.
findings  Findings: what checks say of parts, numbered, for people and programs to sort.
names     What panels and beams may be called, so that every kind of file can say it.
"""
