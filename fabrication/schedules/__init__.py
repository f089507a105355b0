"""
Lists of parts with all that a workshop asks for, in millimetres.

beams       Rows of the schedule for beams and their nodes, with all that a workshop asks for.
panel_text  What a workshop must know of each panel, as user text of a Rhino object.
schedule    The schedule: a row per panel with all that a workshop asks for, in millimetres.
"""
