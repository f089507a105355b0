"""Many results from one graph: sliders moved over ranges, here or on many machines.

A point is one choice of values for the sliders, and a task of its own: what fails is a row that
says so, and costs the others nothing. Points share their results by a store on disk.

points   The points of a sweep, and the names of their folders.
rows     What a sweep found: rows, and a table for spreadsheets, pandas and Parquet.
sweep    Results for all combinations of slider values.
tasks    One point, wherever it is run.
workers  Who runs the points: this process, others, any executor, a cluster of Dask.
"""
