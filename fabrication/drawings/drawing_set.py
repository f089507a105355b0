"""A set of drawings: key plans, sheets of panels by moulds, sheets of beams."""

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from ...kernel.errors import InputError
from ..dates import source_date
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..schedules.beam_records import beam_records
from ..schedules.materials import parse_material
from ..schedules.panel_records import panel_records
from ..schedules.records import Record
from .beam_sheets import beam_pages
from .dxf import format_dxf
from .key_plan import key_plan_pages
from .pages import PAPERS, Page, TitleBlock, finish_pages, join_pages
from .panel_sheets import panel_pages
from .pdf import format_pdf
from .svg import format_svg


@dataclass(frozen=True)
class DrawingOptions:
    """How a set of drawings looks, and what its title blocks say.

    Attributes
    ----------
    paper : str
        Size of the pages, A4 to A0, which lie across.
    project, revision : str
    date : str
        Empty for that of the environment variable SOURCE_DATE_EPOCH, or today.
    panel_material, beam_material : str
        As `parse_material` takes them.
    """

    paper: str = "A3"
    project: str = "spheremesh"
    revision: str = "-"
    date: str = ""
    panel_material: str = "glass"
    beam_material: str = "steel"


_USUAL: Final = DrawingOptions()


def write_drawings(
    model: Model, path: str | os.PathLike[str], options: DrawingOptions = _USUAL
) -> Written:
    """Write a set of drawings of panels and beams.

    ``.pdf`` has its pages, ``.svg`` all of them below each other, and ``.dxf`` as well, but so
    large that what is drawn has its true size in millimetres.

    Raises InputError if suffix, units, paper, material or SOURCE_DATE_EPOCH are of no use,
    there is nothing to draw, two parts have the same name or one is not finite, or the file
    cannot be written; MissingLibraryError if reportlab is missing, which writes ``.pdf``.
    """
    target = Path(path)
    check_suffix(target, ".pdf", ".dxf", ".svg")
    check_model(model, target)
    if options.paper not in PAPERS:
        raise InputError(f"unknown paper {options.paper!r}: use one of {', '.join(PAPERS)}")
    pages = drawing_pages(model, options)
    suffix = target.suffix.lower()
    if suffix == ".pdf":
        content = format_pdf(pages, options.project)
    elif suffix == ".dxf":
        content = format_dxf(join_pages(pages, true_size=True), ()).encode()
    else:
        content = format_svg(join_pages(pages, true_size=False), on_paper=True).encode()
    with replacing(target) as temporary:
        temporary.write_bytes(content)
    return Written(target, counts={"pages": len(pages)})


def drawing_pages(model: Model, options: DrawingOptions = _USUAL) -> list[Page]:
    """The pages of a set: key plans, panels mould by mould, beams."""
    panels, beams, units = model.panels, model.beams, model.units
    panels = panels if panels is not None and panels.ids else None
    beams = beams if beams is not None and beams.ids else None
    records: dict[str, Record] = {}
    if panels is not None:
        records |= panel_records(panels, units, parse_material(options.panel_material))
    if beams is not None:
        records |= beam_records(beams, units, parse_material(options.beam_material))
    pages = key_plan_pages(Model(panels, beams, units), records, options.paper)
    if panels is not None:
        pages += panel_pages(panels, units, records, options.paper)
    if beams is not None:
        pages += beam_pages(beams, units, records, options.paper)
    finish_pages(pages, TitleBlock(options.project, options.revision, options.date or _today()))
    return pages


def _today() -> str:
    """The date of SOURCE_DATE_EPOCH, or today."""
    return f"{source_date() or datetime.now(UTC):%Y-%m-%d}"
