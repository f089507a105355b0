"""Direct solution of symmetric, positive definite sparse systems."""

import importlib.util
from typing import Any

import numpy as np

from ..arrays import FloatArray


def solve_definite(matrix: Any, shift: float, right: FloatArray) -> FloatArray:  # noqa: ANN401
    """
    Solve ``(H + shift I) x = b`` by factorisation.

    Parameters
    ----------
    matrix : (n, n) sparse array
        Symmetric, positive semidefinite H.
    shift : float
        Positive.
    right : (n,) float array
        Vector b.

    Returns
    -------
    (n,) float array
        The solution.

    Notes
    -----
    CHOLMOD where scikit-sparse is installed, else SuperLU in its symmetric mode: its default
    ordering fills in ten times as much on these meshes.
    """
    from scipy.sparse import csc_array, eye_array

    shifted: Any = csc_array(matrix + shift * eye_array(len(right)))
    if importlib.util.find_spec("sksparse") is not None:
        return solve_by_cholmod(shifted, right)
    return solve_by_superlu(shifted, right)


def solve_by_superlu(matrix: Any, right: FloatArray) -> FloatArray:  # noqa: ANN401
    """
    Solve ``H x = b`` by SuperLU.

    Parameters
    ----------
    matrix : (n, n) csc_array
        Symmetric, positive definite H.
    right : (n,) float array
        Vector b.

    Returns
    -------
    (n,) float array
        The solution.
    """
    from scipy.sparse import linalg

    solver: Any = linalg
    factors = solver.splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.asarray(factors.solve(right), np.float64)


def solve_by_cholmod(matrix: Any, right: FloatArray) -> FloatArray:  # noqa: ANN401
    """
    Solve ``H x = b`` by CHOLMOD; needs scikit-sparse 0.4.

    Parameters
    ----------
    matrix : (n, n) csc_array
        Symmetric, positive definite H.
    right : (n,) float array
        Vector b.

    Returns
    -------
    (n,) float array
        The solution.
    """
    from scipy.sparse import csc_matrix

    cholmod: Any = importlib.import_module("sksparse.cholmod")
    return np.asarray(cholmod.cholesky(csc_matrix(matrix))(right), np.float64)
