"""Parts of a model as rectangles on stock sheets."""

from typing import Any

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import scale_beams
from ...kernel.beams.contours import beam_contours, contour_boxes
from ...kernel.errors import InputError
from ...kernel.panels.facts import packing_sizes, panel_radii
from ...kernel.panels.panels import Panels, scale_panels
from ..model import Model, check_parts
from ..units import millimeters_per
from .nesting import Nesting, Stock, nest_rectangles


def nest_model(model: Model, stock: Stock) -> tuple[Nesting, list[dict[str, Any]]]:
    """Nest panels or beams; the nesting, and a row for each piece.

    Raises InputError if there are both or neither, or as `nest_rectangles` and `check_parts`.
    """
    factor = millimeters_per(model.units)
    if model.panels is not None and model.beams is not None:
        raise InputError("panels and beams are not cut from the same sheets: nest one of both")
    if model.panels is not None:
        panels = check_parts(model.panels, "panel", "sheets")
        names, sizes = panels.ids, blank_sizes(scale_panels(panels, factor))
    else:
        beams = check_parts(model.beams, "beam", "sheets")
        boxes = contour_boxes(beam_contours(scale_beams(beams, factor)))
        names, sizes = beams.ids, boxes[:, 1] - boxes[:, 0]
    found = nest_rectangles(sizes, stock)
    lying = np.where(found.is_turned[:, None], sizes[:, ::-1], sizes)
    rows = [
        {
            "id": name, "sheet": sheet + 1, "x_mm": x, "y_mm": y, "width_mm": width,
            "height_mm": height, "is_turned": turned,
        }
        for name, sheet, (x, y), (width, height), turned in zip(
            names, found.sheets.tolist(), np.round(found.places, 3).tolist(),
            np.round(lying, 3).tolist(), found.is_turned.tolist(), strict=True,
        )
    ]  # fmt: skip
    return found, rows


def blank_sizes(panels: Panels) -> FloatArray:
    """Length and width (P, 2) of the flat sheets from which panels are formed.

    Those of the box of a panel, measured along the sphere of its mould.
    """
    sizes = packing_sizes(panels)[:, :2]
    curvatures = (1 / panel_radii(panels).radii)[:, None]
    half = np.minimum(curvatures * sizes / 2, 1.0)
    arcs = 2 * np.divide(np.arcsin(half), curvatures, out=sizes / 2, where=curvatures > 0)
    return np.asarray(arcs)
