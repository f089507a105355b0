"""The report: what a panelling came to, as one page to read and to print.

charts    Histograms and bars, as pictures in lines of text.
diagram   The graph that made it, as a picture.
document  The page: before and after, moulds, gaps, how to reproduce it.
faults    What is wrong: the verdict, rejected parts and findings by kind.
pictures  Flat panels and spheres under the same stripes, small.
tables    Tables of the page.
"""
