"""Ports: the facts of an input or output of a node, and the checks of what it is given."""

import inspect
import os
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from .annotations import Value, type_name
from .arrays import LARGEST
from .errors import GraphError
from .kinds import accepts, is_bool, record_fault
from .stores.digests import digest

REQUIRED = inspect.Parameter.empty
UNITS = ("mm", "cm", "m", "in", "ft")


@dataclass(frozen=True, eq=False)
class Port:
    """Facts about one input or output of a node.

    In a signature only what the annotation cannot say is given, for example
    ``Annotated[float, Port(unit="deg", min=0, max=90)]``; `@node` fills in the rest.

    Attributes
    ----------
    name : str
        Name of the port: of the argument, or of the field of the result.
    type : type
        Annotation without the facts.
    default : object
        Value of an input that is not wired; ``REQUIRED`` if there is none.
    help : str
        What it is; by default the text of the docstring.
    unit : str
        Unit of a number, such as ``"deg"``; empty for model units or pure numbers.
    min, max : float, optional
        Range of a number, the ends included.
    choices : tuple, optional
        The values allowed.
    reads : bool
        A path that the node reads: it runs again when the file has changed.
    writes : bool
        A path that the node writes: it runs again when the file is gone or has changed.
    graph_units : bool
        When not wired, the input is the units of the graph.
    """

    name: str = ""
    type: Any = Any
    default: Any = REQUIRED
    help: str = ""
    unit: str = ""
    min: float | None = None
    max: float | None = None
    choices: tuple[Any, ...] = ()
    reads: bool = False
    writes: bool = False
    graph_units: bool = False


ReadPath: TypeAlias = Annotated[str | os.PathLike[str], Port(reads=True)]
WritePath: TypeAlias = Annotated[str | os.PathLike[str], Port(writes=True)]
Length: TypeAlias = Annotated[float, Port(min=0)]
Units: TypeAlias = Annotated[Literal["mm", "cm", "m", "in", "ft"], Port(graph_units=True)]


def check_value(port: Port, value: object, where: str) -> None:
    """Refuse a value that an input does not accept.

    Parameters
    ----------
    port : Port
        The input.
    value : object
        The value for it.
    where : str
        How the message names the input, ``"step.port"``.

    Raises
    ------
    GraphError
        If the type, the range or the choice is wrong; the message says what is allowed.
    """
    if not accepts(port.type, value):
        fault = record_fault(port.type, value)
        raise GraphError(f"{where} = {brief(value)}: must be {type_name(port.type)}{fault}")
    check_range(value, port, where)


def check_range(value: object, port: Port, where: str) -> None:
    """Refuse a number out of range, or a value that is none of the choices.

    Parameters
    ----------
    value : object
    port : Port
        Holds the range and the choices.
    where : str
        How the message names the place.

    Raises
    ------
    GraphError
        The message says what is allowed.
    """
    is_array = isinstance(value, np.ndarray)
    if port.choices and value is not None and (is_array or value not in port.choices):
        allowed = ", ".join(map(repr, port.choices))
        raise GraphError(f"{where} = {brief(value)}: must be one of {allowed}")
    if not isinstance(value, int | float | np.integer | np.floating) or is_bool(value):
        return
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise GraphError(f"{where}: a whole number has 64 bits at most")
    size = abs(float(cast("float", value)))
    if 0 < size < np.inf and not 1 / LARGEST <= size <= LARGEST:
        raise GraphError(
            f"{where} = {value}: must be 0 or between {1 / LARGEST:g} and {LARGEST:g} in size"
        )
    low, high = port.min, port.max
    # written so that a NaN is outside of every range
    if (low is not None and not value >= low) or (high is not None and not value <= high):
        parts = [f"at least {low}"] * (low is not None) + [f"at most {high}"] * (
            high is not None
        )
        unit = f" {port.unit}" if port.unit else ""
        raise GraphError(f"{where} = {value}: must be {' and '.join(parts)}{unit}")


def check_slider(value: object, port: Port) -> None:
    """Refuse a slider whose range is none, or that holds what is no value.

    Parameters
    ----------
    value : object
        What it holds.
    port : Port
        Its name and range.

    Raises
    ------
    GraphError
        The message names the slider.
    """
    where = f"param {port.name}"
    for name, end in (("min", port.min), ("max", port.max)):
        if end is not None and (not isinstance(end, int | float) or is_bool(end)):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise GraphError(f"{where}: {name} = {brief(end)}: must be a number")
    for choice in port.choices:
        if not isinstance(choice, bool | int | float | str | None):
            raise GraphError(f"{where}: choice {brief(choice)}: must be a number or a text")
    check_range(value, port, where)
    try:
        digest(value)
    except TypeError as error:
        raise GraphError(f"{where}: {error}") from error


def brief(value: Value) -> str:
    """A value in the room that a message has.

    Parameters
    ----------
    value : object

    Returns
    -------
    str
        Arrays by kind and shape, all else by the first 60 characters.
    """
    if isinstance(value, np.ndarray):
        array = cast("NDArray[Any]", value)
        return f"{array.dtype} array of shape {array.shape}"
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
