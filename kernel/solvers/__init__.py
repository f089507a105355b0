"""
Solvers of least-squares problems and of the linear systems in them.

blocks               Sparse Jacobians made of small dense blocks.
conjugate_gradients  Truncated conjugate gradients for the steps of a descent.
factorization        Direct solution of sparse systems.
levenberg_marquardt  Levenberg-Marquardt: least squares with steps that are taken only if the
                     energy falls.
normal_equations     Damped Gauss-Newton steps of large sparse problems.
products             Multiplication by ``JᵀJ`` without forming it.
symmetric            Symmetric systems with one unknown per face and one entry per edge.
"""
