"""
The audit before files go out: numbered findings, errors apart from notes.

beams   The audit of beams: numbered findings, errors apart from notes, as for panels.
panels  The audit before files go out: numbered findings about panels, errors apart from
        notes.
"""
