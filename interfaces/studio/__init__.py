"""The studio: a graph on a canvas in the browser, what it makes beside it.

The page is written in `source/` (see its README) and bundled once into `bundle/`; here are the
graph that it edits, the process that runs it, and what is drawn of its results. A page sends
operations and is told by events what has become of them; several pages show the same graph.

application  Requests of the page and their answers; whatever else comes is for Hops.
catalogue    What the page is told of nodes: ports, fields, what fits what.
channels     Events for all pages that are open.
code         A graph as Python code that makes it again.
document     The graph that is open: undo, its file and earlier versions of that.
folder       The folder of the user that the studio may read from and write to.
operations   Edits as the page sends them: another graph, or one sentence why not.
previews     What is shown of a value: a picture, a table, a histogram or a text.
runs         Runs in a process of its own: the newest counts, and cancel kills.
scenes       Values as pictures, in the binary format of the viewer's page.
session      One graph, the pages that show it, and the process that runs it.
templates    Graphs to start from.
worker       The process that runs graphs: warm, and gone at once when it is killed.
"""
