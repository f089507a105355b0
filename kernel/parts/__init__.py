"""What panels, beams and nodes are called, and what is said of them.

assembly_order  In which order parts may be put up: from below, each beside one that stands.
colors          Names and colours of moulds: the same in every file and picture.
findings        Findings: what checks say of parts, numbered, for people and programs to sort.
records         Records of parts: a row per part or per corner, choosing some, and which are
                finite.
"""
