"""Rows of tables, each measured in a process of its own."""

import multiprocessing
import os
import resource
import warnings
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import numpy as np


class Table(NamedTuple):
    """A table of the page: what it shows, its columns, and rows of text and numbers."""

    title: str
    text: str
    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]


def measured(function: Callable[..., Any], *arguments: object) -> tuple[Any, float]:
    """Result of a call in a process of its own, and the most memory that it took, in GB."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_measure, args=(theirs, function, arguments))
    os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"
    process.start()
    theirs.close()
    result, peak = ours.recv()
    process.join()
    return result, peak


def _measure(
    line: Connection, function: Callable[..., Any], arguments: tuple[object, ...]
) -> None:
    warnings.simplefilter("ignore")
    result = function(*arguments)
    line.send((result, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6))


def exponent(counts: Sequence[float], seconds: Sequence[float]) -> float:
    """By which power of the count seconds grow, from the first to the last."""
    return float(np.log(seconds[-1] / seconds[0]) / np.log(counts[-1] / counts[0]))
