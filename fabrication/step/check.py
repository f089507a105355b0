"""A structural check of STEP files (ISO 10303-21) that needs no CAD kernel.

A CAD kernel repairs what it reads, so reading a file back proves little. Here the text itself
is judged: frame and header, the syntax of every entity, expected types with their number of
parameters, references in both directions, closed loops, and edges used once each way in a
solid.
"""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np

from ...kernel.arrays import BoolArray, IntArray
from ...kernel.errors import InputError
from ...kernel.parts.findings import Finding

ENTITIES: Final = {
    b"ADVANCED_BREP_SHAPE_REPRESENTATION": 3, b"ADVANCED_FACE": 4, b"APPLICATION_CONTEXT": 1,
    b"APPLICATION_PROTOCOL_DEFINITION": 4, b"AREA_MEASURE": 1, b"AXIS2_PLACEMENT_3D": 4,
    b"B_SPLINE_CURVE_WITH_KNOTS": 9, b"CARTESIAN_POINT": 2, b"CIRCLE": 3, b"CLOSED_SHELL": 2,
    b"COLOUR_RGB": 4, b"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION": 2, b"CONVERSION_BASED_UNIT": 2,
    b"CURVE_STYLE": 4, b"CYLINDRICAL_SURFACE": 3, b"DEFINITIONAL_REPRESENTATION": 3,
    b"DERIVED_UNIT": 1, b"DERIVED_UNIT_ELEMENT": 2, b"DIMENSIONAL_EXPONENTS": 7,
    b"DIRECTION": 2, b"DRAUGHTING_PRE_DEFINED_CURVE_FONT": 1, b"EDGE_CURVE": 5, b"EDGE_LOOP": 2,
    b"ELLIPSE": 4, b"FACE_BOUND": 3, b"FACE_OUTER_BOUND": 3, b"FILL_AREA_STYLE": 2,
    b"FILL_AREA_STYLE_COLOUR": 2, b"GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION": 3,
    b"GEOMETRIC_CURVE_SET": 2, b"GEOMETRIC_REPRESENTATION_CONTEXT": 1,
    b"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT": 1, b"GLOBAL_UNIT_ASSIGNED_CONTEXT": 1,
    b"ITEM_DEFINED_TRANSFORMATION": 4, b"LENGTH_MEASURE": 1, b"LENGTH_MEASURE_WITH_UNIT": 2,
    b"LENGTH_UNIT": 0, b"LINE": 3, b"MANIFOLD_SOLID_BREP": 2,
    b"MANIFOLD_SURFACE_SHAPE_REPRESENTATION": 3, b"MEASURE_REPRESENTATION_ITEM": 3,
    b"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION": 3, b"NAMED_UNIT": 1,
    b"NEXT_ASSEMBLY_USAGE_OCCURRENCE": 6, b"OPEN_SHELL": 2, b"ORIENTED_EDGE": 5,
    b"PARAMETRIC_REPRESENTATION_CONTEXT": 0, b"PCURVE": 3, b"PLANE": 2, b"PLANE_ANGLE_UNIT": 0,
    b"PRESENTATION_LAYER_ASSIGNMENT": 3, b"PRESENTATION_STYLE_ASSIGNMENT": 1, b"PRODUCT": 4,
    b"PRODUCT_CONTEXT": 3, b"PRODUCT_DEFINITION": 4, b"PRODUCT_DEFINITION_CONTEXT": 3,
    b"PRODUCT_DEFINITION_FORMATION": 3, b"PRODUCT_DEFINITION_SHAPE": 3,
    b"PRODUCT_RELATED_PRODUCT_CATEGORY": 3, b"PROPERTY_DEFINITION": 3,
    b"PROPERTY_DEFINITION_REPRESENTATION": 2, b"REPRESENTATION": 3,
    b"REPRESENTATION_CONTEXT": 2, b"REPRESENTATION_RELATIONSHIP": 4,
    b"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION": 1,
    b"SHAPE_DEFINITION_REPRESENTATION": 2, b"SHAPE_REPRESENTATION": 3,
    b"SHAPE_REPRESENTATION_RELATIONSHIP": 0, b"SHELL_BASED_SURFACE_MODEL": 2, b"SI_UNIT": 2,
    b"SOLID_ANGLE_UNIT": 0, b"SPHERICAL_SURFACE": 3, b"STYLED_ITEM": 3, b"SURFACE_CURVE": 4,
    b"SURFACE_SIDE_STYLE": 2, b"SURFACE_STYLE_FILL_AREA": 1, b"SURFACE_STYLE_USAGE": 2,
    b"TRIMMED_CURVE": 6, b"UNCERTAINTY_MEASURE_WITH_UNIT": 4, b"VECTOR": 3, b"VERTEX_POINT": 2,
    b"VOLUME_MEASURE": 1,
}  # fmt: skip
"""Types of entities that the library writes, and their numbers of parameters."""

ROOTS: Final = {
    b"APPLICATION_PROTOCOL_DEFINITION", b"SHAPE_DEFINITION_REPRESENTATION",
    b"PRESENTATION_LAYER_ASSIGNMENT", b"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
    b"PRODUCT_RELATED_PRODUCT_CATEGORY", b"PROPERTY_DEFINITION_REPRESENTATION",
    b"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION",
}  # fmt: skip
"""Types that nothing refers to."""

SCHEMAS: Final = (b"AUTOMOTIVE_DESIGN", b"AP242_MANAGED_MODEL_BASED_3D_ENGINEERING")

SHOWN: Final = 100
"""Findings of one code that are listed; one more says how many are not."""

_STRING = re.compile(rb"'(?:[^']|'')*'")
_DIRECTIVES = re.compile(
    rb"'(?:[^\\]|\\\\|\\S\\.|\\P[A-I]\\|\\X\\[0-9A-F]{2}"
    rb"|\\X2\\(?:[0-9A-F]{4})+\\X0\\|\\X4\\(?:[0-9A-F]{8})+\\X0\\)*'"
)
_ATOM = re.compile(
    rb"#[0-9]+|''|(?<![A-Z0-9_.])[+-]?[0-9]+(?:\.[0-9]*(?:E[+-]?[0-9]+)?)?"
    rb"|\.[A-Z_][A-Z0-9_]*\.|[$*]"
)
_LIST = re.compile(rb"(?<![A-Z0-9_])\((?:v(?:,v)*)?\)")
_TYPED = re.compile(rb"(?<=[(,])[A-Z][A-Z0-9_]*\(v\)(?=[,)])")
_SIMPLE = re.compile(rb"v=([A-Z][A-Z0-9_]*)\(((?:v(?:,v)*)?)\)")
_COMPLEX = re.compile(rb"v=\(((?:[A-Z][A-Z0-9_]*\((?:v(?:,v)*)?\)){2,})\)")
_PART = re.compile(rb"([A-Z][A-Z0-9_]*)\(([v,]*)\)")


@dataclass(frozen=True)
class _Text:
    """Data section without blanks and with empty strings; numbers and types of entities."""

    data: bytes
    ids: IntArray
    types: list[bytes]

    def places(self, words: list[bytes]) -> IntArray:
        """Places of entities among all, by their numbers as written."""
        return np.searchsorted(np.sort(self.ids), _numbers(words))


def check_part21(path: str | os.PathLike[str]) -> tuple[Finding, ...]:
    """Check the structure of a STEP file as the library writes them.

    What is wrong, empty if nothing is. S101 frame, S102 header, S103 characters and strings,
    S104 syntax, S105 unexpected type, S106 number of parameters, S201 number used twice, S202
    reference to nothing, S203 entity that nothing uses, S301 open loop, S302 edge of a solid
    not used once each way, S303 no geometry. Of each code the first `SHOWN` are listed, and one
    more says how many there are. Raises InputError if the file cannot be read.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error
    findings = [*_characters(content)]
    stripped = _STRING.sub(b"''", content).translate(None, b" \n\r\t")
    frame = re.fullmatch(
        rb"ISO-10303-21;HEADER;(.*?)ENDSEC;DATA;(.*)ENDSEC;END-ISO-10303-21;",
        stripped,
        re.DOTALL,
    )
    if frame is None:
        missing = "no frame of ISO-10303-21, HEADER, DATA and their ends"
        return (*findings, Finding("S101", "file", missing))
    findings += _header(frame[1], content)
    text, syntax = _read(frame[2])
    findings += [*syntax, *_references(text)]
    # What nothing refers to does no harm; anything else would lead nowhere.
    if all(finding.code == "S203" for finding in findings):
        findings += _topology(text)
    return tuple(findings)


def _some(code: str, ids: Iterable[int], message: str) -> list[Finding]:
    """A finding per entity, the first of them in full."""
    numbers = iter(ids)
    result = [Finding(code, f"#{i}", message) for i in islice(numbers, SHOWN)]
    rest = sum(1 for _ in numbers)
    if rest:
        result.append(Finding(code, "file", f"{rest} more: {message}", float(rest)))
    return result


def _characters(content: bytes) -> list[Finding]:
    alien = content.translate(None, bytes(range(32, 127)) + b"\n\r\t")
    if alien:
        return [Finding("S103", "file", f"{len(alien)} characters beyond ASCII", len(alien))]
    if b"\\" not in content:
        return []
    bad = [x for x in _STRING.findall(content) if b"\\" in x and not _DIRECTIVES.fullmatch(x)]
    findings = [
        Finding("S103", "file", f"string {x[:200].decode()} has an unknown directive")
        for x in bad[:SHOWN]
    ]
    if rest := len(bad[SHOWN:]):
        message = f"{rest} more: a string has an unknown directive"
        findings.append(Finding("S103", "file", message, float(rest)))
    return findings


def _header(header: bytes, content: bytes) -> list[Finding]:
    kinds = re.findall(rb"([A-Z_]+)\(", header)
    findings: list[Finding] = []
    if kinds[:3] != [b"FILE_DESCRIPTION", b"FILE_NAME", b"FILE_SCHEMA"]:
        message = "the header does not hold FILE_DESCRIPTION, FILE_NAME and FILE_SCHEMA"
        findings.append(Finding("S102", "file", message))
    schema = content.partition(b"FILE_SCHEMA")[2].partition(b";")[0]
    if not any(name in schema for name in SCHEMAS):
        findings.append(Finding("S102", "file", "the schema is neither AP214 nor AP242"))
    return findings


def _read(data: bytes) -> tuple[_Text, list[Finding]]:
    """Instances, and what is wrong with their syntax."""
    instances = data.split(b";")
    findings: list[Finding] = []
    if instances.pop():
        findings.append(Finding("S104", "file", "the last entity is not closed"))
    numbers = [instance.partition(b"=")[0][1:] for instance in instances]
    usable = [number.isdigit() and len(number) < 10 for number in numbers]
    ids = np.array(
        [int(x) if good else -1 for x, good in zip(numbers, usable, strict=True)], np.int64
    )
    # Entities differ in few ways once their values are gone: judge each way once.
    forms = _ATOM.sub(b"v", data).split(b";")[:-1]
    verdicts = {form: _judge(form) for form in set(forms)}
    kinds = [verdicts[form][0] for form in forms]
    for code, message in (
        ("S104", "cannot be read: not #number=TYPE(parameters)"),
        ("S105", "a type that is not expected"),
        ("S106", "has too many or too few parameters"),
    ):
        wrong = {form for form, (_, found) in verdicts.items() if found == code}
        if wrong:
            found = (i for i, form in zip(ids.tolist(), forms, strict=True) if form in wrong)
            findings += _some(code, found, message)
    return _Text(data, ids, kinds), findings


def _judge(form: bytes) -> tuple[bytes, str]:
    """Type of an entity whose values are all ``v``, and the code of what is wrong with it."""
    before = b""
    while before != form:
        before, form = form, _LIST.sub(b"v", form) if not _COMPLEX.fullmatch(form) else form
        form = _TYPED.sub(b"v", form)
    simple, several = _SIMPLE.fullmatch(form), _COMPLEX.fullmatch(form)
    if simple is None and several is None:
        return b"", "S104"
    parts = _PART.findall(form)
    if any(kind not in ENTITIES for kind, _ in parts):
        return parts[0][0], "S105"
    if any(ENTITIES[kind] != values.count(b"v") for kind, values in parts):
        return parts[0][0], "S106"
    return parts[0][0] if simple else b"", ""


def _references(text: _Text) -> list[Finding]:
    ids, counts = _distinct(text.ids)
    findings = _some("S201", ids[counts > 1].tolist(), "is defined more than once")
    used, _ = _distinct(_numbers(re.findall(rb"#([0-9]+)(?![0-9]*=)", text.data)))
    missing = np.setdiff1d(used, ids, assume_unique=True)
    findings += _some("S202", missing.tolist(), "is referred to but not there")
    is_root = np.array([kind in ROOTS for kind in text.types], bool)
    needed, _ = _distinct(text.ids[~is_root])
    unused = np.setdiff1d(needed, used, assume_unique=True)
    return findings + _some("S203", unused.tolist(), "is there but nothing refers to it")


def _distinct(values: IntArray) -> tuple[IntArray, IntArray]:
    """Values without repetition, ascending, and how often they occur."""
    ordered = np.sort(values)
    starts = np.flatnonzero(np.diff(ordered, prepend=-2) != 0)
    return ordered[starts], np.diff(starts, append=len(ordered))


def _numbers(words: list[bytes]) -> IntArray:
    return np.array(words, dtype="S18").astype(np.int64) if words else np.zeros(0, np.int64)


@dataclass(frozen=True)
class _Lists:
    """Lists of references: (n,) entities, (n + 1,) bounds, the members one after another."""

    ids: IntArray
    bounds: IntArray
    members: IntArray

    @property
    def owners(self) -> IntArray:
        return np.repeat(np.arange(len(self.ids)), np.diff(self.bounds))


def _lists(text: _Text, kinds: bytes, before: bytes = b"") -> _Lists:
    """Entities ``TYPE('',before(#1,#2,...)...)``."""
    pattern = rb"#([0-9]+)=(?:" + kinds + rb")\(''," + before + rb"\(?((?:#[0-9]+,?)+)\)?"
    found = re.findall(pattern, text.data)
    counts = [words.count(b"#") for _, words in found]
    members = text.places(re.findall(rb"[0-9]+", b"".join(words for _, words in found)))
    bounds = np.concatenate([[0], np.cumsum(np.array(counts, np.int64))])
    return _Lists(text.places([number for number, _ in found]), bounds, members)


def _uses(
    text: _Text, kinds: bytes, before: bytes = b""
) -> tuple[IntArray, IntArray, BoolArray]:
    """Entities ``TYPE('',before #1,.T.)``: their numbers, what they refer to, their senses."""
    pattern = rb"#([0-9]+)=(?:" + kinds + rb")\(''," + before + rb"#([0-9]+),\.([TF])\.\)"
    found = re.findall(pattern, text.data)
    numbers, referred, senses = zip(*found, strict=True) if found else ((), (), ())
    return (
        text.places(list(numbers)),
        text.places(list(referred)),
        np.array([sense == b"T" for sense in senses], bool),
    )


def _topology(text: _Text) -> list[Finding]:
    """Loops close; in closed shells every edge is used once each way."""
    size, numbers = len(text.ids), np.sort(text.ids)
    edge_pattern = rb"#([0-9]+)=EDGE_CURVE\('',#([0-9]+),#([0-9]+),"
    edges = text.places([x for row in re.findall(edge_pattern, text.data) for x in row])
    edges = edges.reshape(-1, 3)
    if len(edges) == 0:
        return [Finding("S303", "file", "there is no edge in the file")]
    ends = np.full((size, 2), -1)
    ends[edges[:, 0]] = edges[:, 1:]
    oriented, edge, forward = _uses(text, b"ORIENTED_EDGE", rb"\*,\*,")
    first = np.full((size, 2), -1)
    first[oriented] = np.where(forward[:, None], ends[edge], ends[edge][:, ::-1])
    edge_of, forward_of = np.full(size, -1), np.zeros(size, bool)
    edge_of[oriented], forward_of[oriented] = edge, forward

    loops = _lists(text, b"EDGE_LOOP")
    following = np.arange(1, len(loops.members) + 1)
    following[loops.bounds[1:] - 1] = loops.bounds[:-1]
    start, end = first[loops.members].T
    is_open = np.logical_or.reduceat(end != start[following], loops.bounds[:-1])
    opened = numbers[loops.ids[is_open]].tolist()
    findings = _some("S301", opened, "the edges do not close the loop")

    faces, shells = _lists(text, b"ADVANCED_FACE"), _lists(text, b"CLOSED_SHELL")
    bounds, loop, same = _uses(text, b"FACE_BOUND|FACE_OUTER_BOUND")
    face_shell = np.full(size, -1)
    face_shell[shells.members] = shells.ids[shells.owners]
    bound_shell = np.full(size, -1)
    bound_shell[faces.members] = face_shell[faces.ids[faces.owners]]
    loop_shell, loop_sense = np.full(size, -1), np.zeros(size, bool)
    loop_shell[loop], loop_sense[loop] = bound_shell[bounds], same
    owner = loops.ids[loops.owners]
    uses = np.stack(
        [
            loop_shell[owner],
            edge_of[loops.members],
            forward_of[loops.members] == loop_sense[owner],
        ],
        axis=1,
    )
    uses = uses[uses[:, 0] >= 0]
    unmatched = numbers[_unmatched(uses)] if len(uses) else numbers[:0]
    message = "is not used once each way in its solid"
    return findings + _some("S302", unmatched.tolist(), message)


def _unmatched(uses: IntArray) -> IntArray:
    """Edges of closed shells (shell, edge, sense) that are not used once each way."""
    order = np.lexsort((uses[:, 2], uses[:, 1], uses[:, 0]))
    shell, edge, sense = uses[order].T
    starts = np.flatnonzero(
        (np.diff(shell, prepend=-2) != 0) | (np.diff(edge, prepend=-2) != 0)
    )
    counts = np.diff(starts, append=len(order))
    wrong = (counts != 2) | (np.add.reduceat(sense, starts) != 1)
    return edge[starts[wrong]]
