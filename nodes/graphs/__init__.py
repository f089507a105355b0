"""The framework: typed functions as nodes, and the lazy graph that runs them.

A graph is a specification that is edited, a runner, and a store of results; `Graph` is the thin
face of the three.

annotations    How types are read: alternatives, elements, what arrays hold, and their names.
arrays         Arrays at ports: their shape, the kind and size of their numbers, their counts.
editor         A graph under the hands of its user: steps, sliders and wires, added and changed.
errors         What can go wrong with graphs, as types, and how a mistyped name is answered.
graph          The lazy graph: nodes wired together, run as far as a target needs.
history        A graph and how it came about: what it is now, and what it was before.
kinds          The table of types: which values an input takes, and which wires.
node           Typed functions as nodes: the signature is the ports, the docstring the help.
ports          Facts of inputs and outputs, and the checks of what inputs are given.
running        One run of a graph: keys first, then only the steps whose results are not known.
signatures     Signatures as ports: what annotations and docstrings say of inputs and outputs.
specification  What a graph is made of, as records that nobody changes, and as a file.
stores         Results by key, in memory and on disk, bounded in bytes.
sweeps         Many results from one graph: sliders moved over ranges.
"""
