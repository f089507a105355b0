"""What a graph is made of, as records that nobody changes, and as a file.

connections    The checks of what is wired: both ends are named, and what would fit.
differences    What makes one graph of another.
edits          Edits of a graph: each gives another specification.
encoding       What steps are given, as JSON: values, wires, sliders, lists to map over.
file           Graphs as JSON: versioned, in a stable order, and without code.
mermaid        The picture of a graph, as a Mermaid flowchart.
order          Steps in an order in which each stands after those that it needs.
reading        Graph files read: what they say, checked, and the graph that it is.
specification  What a graph is, as a record that nobody changes.
subgraphs      Graphs as nodes of other graphs.
svg            The picture of a graph, as SVG.
wires          Sliders, steps, the wires between them, lists to map over.
"""
