"""Solvers of least-squares problems and of the linear systems in them.

levenberg_marquardt  Least squares with steps that are taken only if the energy falls.
normal_equations     Damped Gauss-Newton steps of large sparse problems.
blocks               Sparse Jacobians made of small dense blocks.
conjugate_gradients  Truncated conjugate gradients for the steps of a descent.
products             Multiplication by ``JᵀJ`` without forming it.
factorization        Direct solution of sparse systems.
definite_systems     Symmetric systems on graphs, solved if they are definite.
weighted_graphs      Pieces of graphs; weighted graphs for the trees and paths of scipy.
"""
