"""The drawing of a connector: what it says, and every way in which it can be wrong."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.processes.antenna_module.connector.connector import (
    Connector,
    parse_connector,
    read_connector,
)
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid
from tests.rigs.sweeps import examples

FOLDER = Path("config/connectors")
SHIPPED = sorted(path for kind in ("pins", "holes") for path in FOLDER.glob(f"*-{kind}.toml"))
TEXT = (FOLDER / "micro-d-15-pins.toml").read_text()


def parsed(old: str = "", new: str = "") -> Connector:
    """The micro-D plug with one change."""
    assert old in TEXT
    return parse_connector(TEXT.replace(old, new, 1).encode(), "changed.toml")


def row(count: int, *, symmetric: bool) -> str:
    """A single row."""
    head = TEXT[: TEXT.index("[[contact]]")].replace(
        "symmetric = false", f"symmetric = {str(symmetric).lower()}"
    )
    return head + "".join(
        f'[[contact]]\nname = "{k}"\nposition_mm = [{0.75 * k:.2f}, 0.0]\n' for k in range(count)
    )


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_drawing_is_read(path: Path) -> None:
    connector = read_connector(path)
    assert path.stem == f"{connector.name}-{connector.kind}"
    assert len(connector.contacts) == 15
    assert not connector.symmetric


def test_it_is_in_si_units() -> None:
    connector = read_connector(FOLDER / "micro-d-15-pins.toml")
    assert connector.least_spacing_m == pytest.approx(np.hypot(0.635e-3, 1.09e-3))
    assert connector.positions_m[0] == pytest.approx([-4.445e-3, 0.545e-3])
    assert connector.seat_depth_m == 2.5e-3
    assert connector.force_n == (5.0, 41.7)


@pytest.mark.parametrize("name", ["micro-d-15", "d-sub-15"])
def test_every_pin_meets_the_hole_of_its_name(name: str) -> None:
    plug = read_connector(FOLDER / f"{name}-pins.toml")
    socket = read_connector(FOLDER / f"{name}-holes.toml")
    assert plug.contacts == socket.contacts
    # Face to face the plug is turned by half a turn about y.
    assert plug.positions_m * [-1.0, 1.0] == pytest.approx(socket.positions_m)
    for key in ("capture_m", "funnel_m", "seat_depth_m", "spring_depth_m", "force_n"):
        assert getattr(plug, key) == getattr(socket, key)


WRONG = {
    "not TOML": ("name =", "name", "is not TOML"),
    "unknown key": ('kind = "pins"', 'kind = "pins"\ncolour = "red"', "unknown key 'colour'"),
    "missing key": ("capture_mm = 0.2\n", "", "missing 'capture_mm'"),
    "kind": ('"pins"', '"balls"', "'pins' or 'holes'"),
    "text for number": ("length_mm = 3.0", 'length_mm = "3"', "length_mm"),
    "true for number": ("length_mm = 3.0", "length_mm = true", "length_mm"),
    "negative": ("length_mm = 3.0", "length_mm = -3.0", "length_mm"),
    "not finite": ("length_mm = 3.0", "length_mm = nan", "length_mm"),
    "twice": ('name = "2"', 'name = "1"', "contact 1 is named twice"),
    "overlap": ("[-3.175, 0.545]", "[-4.4, 0.545]", "contacts 1 and 2 overlap"),
    "capture": ("capture_mm = 0.2", "capture_mm = 0.7", "reaches the next hole"),
    "outline": ("[12.0, 3.9]", "[8.0, 3.9]", "outline_mm"),
    "forces": ("[5.0, 41.7]", "[41.7, 5.0]", "least and greatest"),
    "one force": ("[5.0, 41.7]", "[41.7]", "force_n"),
    "springs": ("spring_depth_mm = 0.5", "spring_depth_mm = 2.5", "less than seat_depth_mm"),
    "funnel": ("funnel_mm = 0.25", "funnel_mm = 0.6", "funnel_mm"),
    "seat": ("seat_depth_mm = 2.5", "seat_depth_mm = 3.5", "longer than the pins"),
    "chamfer": ("chamfer_mm = 0.1", "chamfer_mm = 0.25", "leaves nothing of the tip"),
    "true position": ("true_position_mm = 0.010", "true_position_mm = 0.3", "true_position_mm"),
    "symmetry": ("symmetric = false", "symmetric = true", "after half a turn a contact is"),
    "two numbers": ("[-3.175, 0.545]", "[-3.175]", "position_mm"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=WRONG.keys())
def test_every_mistake_is_named(old: str, new: str, words: str) -> None:
    with pytest.raises(ConnectorFileInvalid, match=words) as fault:
        parsed(old, new)
    assert "changed.toml" in str(fault.value)


def test_a_single_row_looks_the_same_after_half_a_turn_and_must_say_so() -> None:
    with pytest.raises(ConnectorFileInvalid, match="half a turn lays all contacts on others"):
        parse_connector(row(15, symmetric=False).encode(), "row.toml")
    assert parse_connector(row(15, symmetric=True).encode(), "row.toml").symmetric


def test_a_missing_file_is_named() -> None:
    with pytest.raises(ConnectorFileInvalid, match=r"nowhere\.toml: No such file"):
        read_connector(Path("nowhere.toml"))


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(content: bytes) -> None:
    with pytest.raises(ConnectorFileInvalid):
        parse_connector(content, "noise.toml")


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-10, 10**20)
    | st.floats(allow_nan=True)
    | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner),
    max_leaves=4,
)


@settings(max_examples=examples(60), deadline=None)
@given(key=st.sampled_from(sorted(tomllib.loads(TEXT))), value=VALUES)
def test_any_value_of_any_key_is_read_or_refused(key: str, value: Any) -> None:
    data = tomllib.loads(TEXT) | {key: value}
    try:
        connector = parse_connector(_toml(data).encode(), "fuzz.toml")
    except ConnectorFileInvalid:
        return
    assert connector.least_spacing_m > connector.diameter_m > 0


def _toml(data: dict[str, Any]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in data.items())


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        # Escapes, so that every text is one that TOML may hold.
        return '"' + "".join(f"\\U{ord(letter):08x}" for letter in value) + '"'
    if isinstance(value, dict):
        inner = ", ".join(f"{_value(key)} = {_value(item)}" for key, item in value.items())
        return "{" + inner + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return "no-value" if value is None else repr(value)
