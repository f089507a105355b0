"""Solvers of minimisation problems and of the linear systems in them.

A system of several groups of unknowns is reduced to the first, whose elements are faces, and
factorised by dense algebra in fronts. Measured on 50,000 faces of 4 unknowns (one thread): 3 s,
where SuperLU takes 12, cholespy 11 and qdldl 26; and a front that is not positive definite says
so, which a Newton method must know and CHOLMOD's LDLᵀ does not tell.

newton               Newton's method that knows a minimum from a saddle.
minimization         What it is given: energies, a model near a state, and moves.
levenberg_marquardt  Least squares with steps that are taken only if the energy falls.
blocks               Unknowns in groups of elements; sparse Jacobians made of small blocks.
block_patterns       Where the blocks of a Hessian go.
block_systems        Newton systems reduced to the elements that are kept.
multifrontal         Cholesky factors front by front.
dissection           Nested dissection: an order of elimination that fills in little.
factorization        Direct solution of sparse systems.
definite_systems     Symmetric systems on graphs, solved if they are definite.
weighted_graphs      Pieces of graphs; weighted graphs for the trees and paths of scipy.
"""
