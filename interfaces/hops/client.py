"""spheremesh from Rhino's own Python, and from any other: a client without libraries.

Rhino 8 runs Python 3.9, in which spheremesh cannot be installed. Start ``spheremesh serve``,
save this file (it stands at ``/client.py`` of the server) beside your script, and call
components by name::

    import client

    server = client.Server("http://127.0.0.1:5555")
    fitted = server.call("fit_spheres", mesh=mesh)
    best = server.call("minimize_angles", sphere_mesh=fitted["sphere_mesh"])
    print(best["report"], best.warnings)

Numbers, texts, lists, and in Rhino meshes, Breps, curves, points, vectors and planes go in and
come out. Handles such as ``fitted["sphere_mesh"]`` stand for values that stay at the server.
"""

from __future__ import annotations

import importlib
import json
import time
import urllib.error
import urllib.request
from collections.abc import Sequence
from typing import Any

try:  # within Rhino
    _rhino: Any = importlib.import_module("Rhino")
except ImportError:
    _rhino = None

_NUMBERS = {"Boolean": "System.Boolean", "Integer": "System.Int32", "Number": "System.Double"}
_POINTS = {"Point": "Rhino.Geometry.Point3d", "Vector": "Rhino.Geometry.Vector3d"}


class ServerError(RuntimeError):
    """What a component says of an error."""


class Outputs(dict[str, Any]):
    """Outputs by name; ``warnings`` are those of the component."""

    warnings: list[str]


class Server:
    """A running ``spheremesh serve``.

    Parameters
    ----------
    address : str
    timeout : float
        Seconds to wait for a run; it goes on when they are over, and a new call joins it.
    """

    def __init__(self, address: str = "http://127.0.0.1:5555", timeout: float = 3600.0) -> None:
        self.address = address.rstrip("/")
        self.timeout = timeout
        self._known: dict[str, dict[str, Any]] = {}

    def names(self) -> list[str]:
        """The names of all components."""
        return [each["Name"] for each in self._json("/")]

    def describe(self, name: str) -> dict[str, Any]:
        """What a component takes and gives."""
        if name not in self._known:
            self._known[name] = self._json(f"/{name}")
        return self._known[name]

    def call(self, component: str, units: str = "Meters", **inputs: Any) -> Outputs:  # noqa: ANN401
        """Run a component.

        Parameters
        ----------
        component : str
            Its name.
        units : str
            Of the document, as Rhino names them.
        **inputs : object
            By name. None leaves an input out.

        Returns
        -------
        Outputs
            A value for each item, a list for each list, lists of lists for trees.

        Raises
        ------
        ServerError
            If an input is wrong, the run fails, or nobody answers.
        """
        description = self.describe(component)
        kinds = {each["Name"]: each["ParamType"] for each in description["Inputs"]}
        values: list[dict[str, Any]] = []
        for name, value in inputs.items():
            if name not in kinds:
                known = ", ".join(kinds)
                raise ServerError(f"{component} has no input {name!r}; there are {known}")
            if value is not None:
                items = [_item(each, kinds[name]) for each in _several(value, kinds[name])]
                values.append({"ParamName": name, "InnerTree": {"{0}": items}})
        request = {"pointer": component, "modelunits": units, "values": values}
        return _outputs(self._solve(request), description)

    def _solve(self, request: dict[str, Any]) -> dict[str, Any]:
        ends = time.monotonic() + self.timeout
        while True:
            answer = self._json("/solve", request)
            if not answer.get("running"):
                return answer
            if time.monotonic() > ends:
                raise ServerError(answer["message"])

    def _json(self, path: str, request: dict[str, Any] | None = None) -> Any:  # noqa: ANN401
        body = None if request is None else json.dumps(request, allow_nan=False).encode()
        asked = urllib.request.Request(  # noqa: S310 - the address is the user's own
            self.address + path, body, {"Content-Type": "application/json"}
        )
        try:
            with urllib.request.urlopen(asked, timeout=120) as answer:  # noqa: S310
                return json.loads(answer.read())
        except urllib.error.HTTPError as error:
            return _failure(error)
        except OSError as error:
            raise ServerError(
                f"nobody answers at {self.address} ({error}); start spheremesh serve"
            ) from error


def _failure(error: urllib.error.HTTPError) -> dict[str, Any]:
    """An answer that says to wait on; all others are raised."""
    try:
        answer: dict[str, Any] = json.loads(error.read())
        message = str(answer["message"])
    except (ValueError, KeyError, TypeError):
        raise ServerError(f"the server says {error.code} {error.reason}") from error
    if answer.get("running"):
        return answer
    raise ServerError(message) from None


def _several(value: Any, kind: str) -> Sequence[Any]:  # noqa: ANN401
    """The items of a value: three numbers are one point."""
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        return [value]
    items = list(value)
    is_point = kind in _POINTS and len(items) == 3 and isinstance(items[0], (int, float))
    return [items] if is_point else items


def _item(value: Any, kind: str) -> dict[str, str]:  # noqa: ANN401
    """A value as the server takes it."""
    name, data = f"Rhino.Geometry.{kind}", ""
    if kind in _NUMBERS:
        plain = {"Boolean": bool, "Integer": int, "Number": float}[kind](value)
        name, data = _NUMBERS[kind], json.dumps(plain, allow_nan=False)
    elif kind in _POINTS:
        name, data = _POINTS[kind], json.dumps(_axes(value))
    elif kind == "Plane":
        plane: Any = value
        if not isinstance(value, dict):
            names = ("Origin", "XAxis", "YAxis", "ZAxis")
            plane = {axis: _axes(getattr(value, axis)) for axis in names}
        data = json.dumps(plane)
    elif kind == "Text":
        text = value if isinstance(value, str) else json.dumps(_plain(value), allow_nan=False)
        name, data = "System.String", json.dumps(text)
    else:
        data = _encoded(value)
    return {"type": name, "data": data}


def _encoded(value: Any) -> str:  # noqa: ANN401
    """An object of Rhino, of rhino3dm, or as either has encoded it."""
    if hasattr(value, "ToJSON"):
        return str(value.ToJSON(None))
    return json.dumps(value.Encode() if hasattr(value, "Encode") else value)


def _axes(point: Any) -> dict[str, float]:  # noqa: ANN401
    if hasattr(point, "X"):
        return {"X": point.X, "Y": point.Y, "Z": point.Z}
    x, y, z = point
    return {"X": float(x), "Y": float(y), "Z": float(z)}


def _plain(value: Any) -> Any:  # noqa: ANN401
    return value.tolist() if hasattr(value, "tolist") else value


def _outputs(answer: dict[str, Any], description: dict[str, Any]) -> Outputs:
    lists = {each["Name"]: each.get("Access") == "list" for each in description["Outputs"]}
    outputs = Outputs()
    outputs.warnings = list(answer["warnings"])
    for tree in answer["values"]:
        branches = [[_value(item) for item in items] for items in tree["InnerTree"].values()]
        found: Any = branches
        if len(branches) <= 1:
            found = branches[0] if branches else []
            if not lists[tree["ParamName"]]:
                found = found[0] if len(found) == 1 else (found or None)
        outputs[tree["ParamName"]] = found
    return outputs


def _value(item: dict[str, str]) -> Any:  # noqa: ANN401
    """An item as Python has it, or Rhino."""
    kind, data = item["type"], item["data"]
    if kind == "System.String":
        return json.loads(data) if data.startswith('"') and data.endswith('"') else data
    if kind == "System.Double":
        return float(data)
    found = json.loads(data)
    name = kind.rpartition(".")[2]
    if name in ("Point3d", "Vector3d"):
        return _point(found, name)
    if name == "Line":
        ends = _point(found["From"], "Point3d"), _point(found["To"], "Point3d")
        return ends if _rhino is None else _rhino.Geometry.Line(*ends)
    if kind.startswith("System.") or _rhino is None:
        return found
    return _rhino.Runtime.CommonObject.FromJSON(data)


def _point(axes: dict[str, float], kind: str) -> Any:  # noqa: ANN401
    point = (axes["X"], axes["Y"], axes["Z"])
    return point if _rhino is None else getattr(_rhino.Geometry, kind)(*point)
