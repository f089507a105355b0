"""One run of a graph: keys first, then only the steps whose results are not known.

calls      One call of a function, or many: a step mapped over lists.
events     What is told of a run while it goes on, and how it is called off.
files      The files of a run: where paths lead, and that nothing read is written over.
keys       Keys of steps and of items of lists.
matching   Which items of several lists go together.
run        The run itself: what is missing is made, in order.
subgraphs  Graphs within graphs: their steps run among those of the graph around them.
"""
