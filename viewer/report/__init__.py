"""The report: what a panelling came to, as one page to read and to print.

charts    Histograms and bars, as pictures in lines of text.
diagram   The graph that made it, as a picture.
document  The page: before and after, moulds, gaps, what is wrong, how to reproduce it.
pictures  Flat panels and spheres under the same stripes, small.
"""
