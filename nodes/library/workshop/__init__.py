"""What a workshop asks before it starts.

audit      Findings before files go out.
congruent  Panels of one shape.
cost       What a workshop asks for it, and what fewer moulds and flat panels save.
drawings   Drawings: for cutting, of moulds, and whole sets; how pieces lie on sheets.
ifc        Panels and beams in building models.
losses     What moulds and a support cost, and what became of it, in warnings.
picture    Pictures of panels, beams and other things.
report     The report of a panelling.
solids     Panels, beams and nodes as solids for CadQuery.
summary    The report of a panelling, to read and to print.
tables     Tidy tables of parts.
view       A page on which a model turns, shines and answers.
"""
