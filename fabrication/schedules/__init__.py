"""Lists of parts with all that a workshop asks for, in millimetres.

beams       Rows of the schedule for beams and their nodes.
columns     What a page says of parts: the columns that are known in a moment.
panel_text  What a workshop must know of each panel, as user text of a Rhino object.
panels      Rows of the schedule for panels and their moulds.
writer      The schedule of panels and beams as a table, a workbook or JSON.
"""
