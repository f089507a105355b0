"""Price files: what is right is read, and each fault is named."""

from pathlib import Path

import pytest

from spheremesh.fabrication.costs.prices import (
    BeamPrice,
    MouldPrice,
    SheetPrice,
    parse_prices,
    read_prices,
)
from spheremesh.kernel.errors import InputError

WHOLE = """
currency = "EUR"

[[moulds]]
min_radius_m = 5
max_diameter_m = 3.5
each = 900

[[moulds]]
per_m2 = 800.0

[blanks]
per_m2 = 95
flat_per_m2 = 45

[panels]
each = 12
per_m2 = 140

[beams]
density_kg_m3 = 7850
per_kg = 4.5
per_cut = 12

[nodes]
each = 60
"""


def test_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "prices.toml"
    for text in (WHOLE, "\ufeff" + WHOLE.replace("\n", "\r\n")):
        path.write_bytes(text.encode())
        found = read_prices(path)
        assert found.currency == "EUR"
        assert found.moulds == (MouldPrice(5, 3.5, 900, 0), MouldPrice(per_m2=800))
        assert found.blanks == SheetPrice(0, 95, 45)
        assert found.panels == SheetPrice(12, 140, 140)
        assert found.beams == BeamPrice(0, 4.5, 7850, 12)
        assert found.node == 60


def test_one_table_is_enough() -> None:
    found = parse_prices({"moulds": {"each": 3}})
    assert found.moulds == (MouldPrice(each=3),)
    assert (found.blanks, found.panels, found.beams, found.node) == (None,) * 4


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "per_kg = 4.5",
            "per_lb = 4.5",
            "unknown key 'per_lb' in [beams]: it has each, per_kg",
        ),
        ("min_radius_m", "min_radius_mm", "unknown key 'min_radius_mm' in [[moulds]] no. 1"),
        ("per_m2 = 140", "per_m2 = -140", "per_m2 = -140 in [panels] must not be negative"),
        ("per_m2 = 95", 'per_m2 = "95 EUR"', "per_m2 = '95 EUR' in [blanks] must be a number"),
        ("per_m2 = 95", "per_m2 = true", "per_m2 = True in [blanks] must be a number alone"),
        (
            "per_m2 = 95",
            "per_m2 = nan",
            "per_m2 = nan in [blanks] must be a number up to 1e+12",
        ),
        ("per_m2 = 95", "per_m2 = 1e300", "must be a number up to 1e+12"),
        (
            "[nodes]",
            "[knots]",
            "unknown table or key 'knots': there are currency and the tables",
        ),
        ("density_kg_m3 = 7850", "", "per_kg in [beams] needs density_kg_m3"),
        ('"EUR"', "3", "currency must be a short text"),
        ("[nodes]", "[[nodes]]", "[nodes] must be a table with the keys each"),
        ("[nodes]\neach = 60", "[nodes]", "[nodes] needs a price: each"),
        ("each = 900", "", "[moulds] needs a price: each or per_m2"),
        ("per_m2 = 95", "per_m2 = ", "is no price file in TOML: Invalid value (at line 13"),
    ],
)
def test_each_fault_is_named_once(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "prices.toml"
    path.write_text(WHOLE.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as it:
        read_prices(path)
    text = str(it.value)
    assert said in text
    assert text.startswith(str(path))
    assert text.count(said) == 1
    assert "faults" not in text


def test_all_faults_are_named_together() -> None:
    with pytest.raises(
        InputError, match=r"^prices: 3 faults: unknown .*; unknown .*; each = -1"
    ):
        parse_prices({"wood": {}, "nodes": {"each": -1, "price": 3}})
    with pytest.raises(InputError, match="nothing is priced: add a table of moulds"):
        parse_prices({"currency": "CHF"})


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_prices(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_prices(tmp_path)
    (tmp_path / "latin.toml").write_bytes(b'currency = "\xa3"')
    with pytest.raises(InputError, match="is not text in UTF-8"):
        read_prices(tmp_path / "latin.toml")
    (tmp_path / "deep.toml").write_text("a = " + "[" * 100_000, encoding="utf-8")
    with pytest.raises(InputError, match="is no price file in TOML"):
        read_prices(tmp_path / "deep.toml")
