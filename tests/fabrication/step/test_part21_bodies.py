"""Numbers, references and strings in the text of STEP files."""

import re

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from spheremesh.fabrication.breps.records import EdgeBatch, FaceBatch, brep_batch
from spheremesh.fabrication.step.bodies import line_body, step_bodies
from spheremesh.fabrication.step.values import real, string

FINITE = st.floats(allow_nan=False, allow_infinity=False)


@given(FINITE)
def test_law_numbers_are_read_back_as_they_were(number: float) -> None:
    text = real(number)
    assert re.fullmatch(r"[-+]?\d+\.\d*(E[-+]?\d+)?", text)
    assert float(text) == number


@given(st.text())
def test_law_strings_are_read_back_as_they_were(text: str) -> None:
    quoted = string(text)
    assert quoted.isascii()
    assert "\n" not in quoted
    assert re.fullmatch(r"'([^']|'')*'", quoted)
    wide = re.findall(r"\\X4\\([0-9A-F]*)\\X0\\", quoted.replace("\\\\", ""))
    assert all(int(run[i : i + 8], 16) > 0xFFFF for run in wide for i in range(0, len(run), 8))

    def decode(run: re.Match[str]) -> str:
        if not run["codes"]:
            return "\\"
        digits = 2 * int(run["bytes"])
        assert len(run["codes"]) % digits == 0
        codes = [run["codes"][i : i + digits] for i in range(0, len(run["codes"]), digits)]
        return "".join(chr(int(code, 16)) for code in codes)

    directives = r"\\\\|\\X(?P<bytes>[24])\\(?P<codes>[0-9A-F]+)\\X0\\"
    assert re.sub(directives, decode, quoted[1:-1].replace("''", "'")) == text


@given(st.integers(1, 10**8))
def test_law_references_move_with_the_first_entity(first: int) -> None:
    """A triangle: the numbers of its entities are those that it refers to, and no others."""
    corners = [np.eye(3)[[i]] for i in range(3)]
    edges = [EdgeBatch(i, (i + 1) % 3, "LINE", corners[i]) for i in range(3)]
    ring = ((0, True), (1, True), (2, True))
    face = FaceBatch("PLANE", np.concatenate(corners[:2], axis=1), ring)
    batch = brep_batch(np.arange(1), corners, edges, [face], is_solid=False)
    for body in (*step_bodies([batch]), line_body(np.eye(3)[None, :2])):
        text = body.text(first)
        defined = [int(x) for x in re.findall(r"^#(\d+)=", text, re.MULTILINE)]
        assert sorted(defined) == list(range(first, first + body.layout.n_entities))
        used = {int(x) for x in re.findall(r"#(\d+)(?!\d*=)", text)}
        assert used == set(defined) - {first}


def test_bodies_of_one_topology_share_a_layout() -> None:
    corners = [np.full((2, 3), float(i)) for i in range(2)]
    edges = [EdgeBatch(0, 1, "LINE", np.ones((2, 3)))]
    face = FaceBatch("PLANE", np.ones((2, 6)), ((0, True), (0, False)))
    batch = brep_batch(np.arange(2), corners, edges, [face])
    first, second = step_bodies([batch])
    (third, _) = step_bodies([batch])
    assert first.layout is second.layout is third.layout


def test_no_negative_zero_is_written() -> None:
    assert "-0.0" not in line_body(np.array([[[0.0, 0, 0], [-1, -0.0, 0]]])).text(1)
