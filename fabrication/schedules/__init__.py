"""Lists of parts with all that a workshop asks for, in millimetres.

beam_records     Tidy tables of beams, of their ends and holes, and of nodes.
beams            Rows of the schedule for beams and their nodes.
columns          What a page says of parts: the columns that are known in a moment.
data_dictionary  What every column of the tidy tables says.
materials        Materials and their densities.
panel_records    Tidy tables of panels, of their edges, and of moulds.
panel_text       What a workshop must know of each panel, as user text of a Rhino object.
panels           Rows of the schedule for panels and their moulds.
record_files     Tidy tables as files: CSV and Parquet of one, a workbook of all.
records          Tidy tables: columns of plain values, a number or a text in each cell.
writer           The schedule of panels and beams as a table, a workbook or JSON.
"""
