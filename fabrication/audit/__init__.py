"""The audit before files go out: numbered findings, errors apart from notes.

assembly  Checks of parts against each other: overlaps, and corners of panels off their axes.
beams     Checks of beams; each is a function of a `BeamSubject` that returns findings.
panels    Checks of panels, likewise.
report    `audit_model`: all findings on a model, and what each code means.
subjects  What checks look at: parts in millimetres, measured, and what a workshop can do.
"""
