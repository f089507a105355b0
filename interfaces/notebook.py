"""What a notebook shows of meshes, panels and beams: the page of `write_view`, within a cell.

Below the page lies a picture. It is seen where pages within pages are taken out: in notebooks
that are not trusted, and on sites that show notebooks without running them.
"""

import base64
import html
import io
from typing import TypeAlias

from ..fabrication.schedules.columns import beam_columns, panel_columns
from ..fabrication.units import millimeters_per
from ..kernel.beams.beams import Beams
from ..kernel.beams.cutting import cut_beams
from ..kernel.meshes.mesh import Mesh
from ..kernel.panels.cutting import cut_panels
from ..kernel.panels.panels import Panels
from ..kernel.sphere_meshes.fit import face_planes
from ..kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..kernel.support.annuli import Annuli, mean_end_depth
from ..viewer.page.document import PageTexts, page_text
from ..viewer.render import render_image

Shape: TypeAlias = Mesh | SphereMesh | Panels | Beams | Annuli

MOST_PARTS = 20_000
"""More are shown as a picture alone: the page stands within the notebook's file."""

THIN = 0.1
"""Thickness of the beams that stand for annuli, in their depths."""

WIDTH, HEIGHT = 800, 500
"""Of the picture, in pixels; the page is as wide as the cell."""


_FRAME = (
    '<div style="position:relative;width:100%;max-width:1200px;aspect-ratio:{width}/{height}">'
    '<img alt="{words}" style="width:100%" src="data:image/png;base64,{picture}">{page}</div>'
    "<small>{words}</small>"
)
_PAGE = (
    '<iframe title="{words}" style="position:absolute;inset:0;width:100%;height:100%;border:0"'
    ' srcdoc="{page}"></iframe>'
)


def notebook_html(shape: Shape) -> str | None:
    """The view of a shape for a notebook; None if it has nothing to draw."""
    panels, beams = _parts(shape)
    count = panels.n_panels if panels is not None else beams.n_beams if beams is not None else 0
    if not count:
        return None
    words = html.escape(repr(shape))
    page = ""
    if count <= MOST_PARTS:
        page = _PAGE.format(words=words, page=html.escape(_page(panels, beams)))
    return _FRAME.format(
        width=WIDTH, height=HEIGHT, words=words, picture=_picture(panels, beams), page=page
    )


def _parts(shape: Shape) -> tuple[Panels | None, Beams | None]:
    """What stands for a shape: flat panels for a mesh, thin beams for annuli."""
    match shape:
        case Mesh():
            return cut_panels(face_planes(shape))[0], None
        case SphereMesh():
            return cut_panels(shape)[0], None
        case Panels():
            return shape, None
        case Beams():
            return None, shape
        case Annuli():
            return None, cut_beams(shape, THIN * mean_end_depth(shape))[0]


def _page(panels: Panels | None, beams: Beams | None) -> str:
    units = "m"
    texts = PageTexts(
        "",
        panel_columns(panels, units),
        beam_columns(beams, panels, units),
        millimeters=millimeters_per(units),
    )
    return page_text(panels, beams, texts)


def _picture(panels: Panels | None, beams: Beams | None) -> str:
    image = render_image(panels, beams=beams, width=WIDTH, height=HEIGHT, legend=False)
    file = io.BytesIO()
    image.save(file, "PNG")
    return base64.b64encode(file.getvalue()).decode()
