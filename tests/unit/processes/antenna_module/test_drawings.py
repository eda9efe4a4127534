"""Drawings of plug and socket: contact by contact, as they lie when one is in the other."""

import re
from pathlib import Path

import pytest

from cellctl.config.load import problems

PINS, HOLES = "micro-d-15-pins.toml", "micro-d-15-holes.toml"
_POSITION = re.compile(r"position_mm = \[(-?[\d.]+), (-?[\d.]+)\]")


def draw_otherwise(path: Path, x: float, y: float) -> None:
    def changed(found: re.Match[str]) -> str:
        return f"position_mm = [{x * float(found[1])}, {y * float(found[2])}]"

    path.write_text(_POSITION.sub(changed, path.read_text(encoding="utf-8")), encoding="utf-8")


@pytest.mark.parametrize("name", [PINS, HOLES])
@pytest.mark.parametrize(
    ("x", "y", "said"),
    [
        (-1.0, 1.0, "is mirrored in x"),
        (1.0, -1.0, "has its rows exchanged"),
        (-1.0, -1.0, "is turned by half a turn"),
        (1.05, 1.0, "of one name are 0.22 mm apart"),
    ],
)
def test_one_part_that_is_drawn_otherwise(
    cell: Path, name: str, x: float, y: float, said: str
) -> None:
    """Distances between its contacts are the same: pin 1 would be taken for pin 8."""
    draw_otherwise(cell.parent / "connectors" / name, x, y)
    (issue,) = problems(cell)
    assert said in issue.value


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        (PINS, "diameter_mm = 0.5\n", "diameter_mm = 0.25\n"),
        (PINS, "diameter_mm = 0.5\n", "diameter_mm = 0.6\n"),
        (HOLES, "diameter_mm = 0.56\n", "diameter_mm = 0.28\n"),
        (HOLES, "diameter_mm = 0.56\n", "diameter_mm = 1.12\n"),
    ],
)
def test_pins_that_do_not_go_into_their_holes(cell: Path, name: str, old: str, new: str) -> None:
    path = cell.parent / "connectors" / name
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    (issue,) = problems(cell)
    assert "or one is a radius" in issue.value
