"""Sizes in the drawings of the antenna cell that are half or twice what they should be."""

import re
from collections.abc import Sequence
from pathlib import Path
from shutil import copytree

import pytest

from cellctl.config.commissioning import examine_before_commissioning

CONFIG = Path(__file__).parents[5] / "config"
PINS, HOLES = "micro-d-15-pins", "micro-d-15-holes"
ABOVE, BELOW = "reference-plate-above", "reference-plate-below"
REFERENCE = "processes.antenna-module.reference"

Change = tuple[str, str, str]
"""A drawing, what stands in it, what is written instead."""


def remarks(folder: Path, changes: Sequence[Change], *, calibrated: bool = True) -> dict[str, str]:
    """What is said beside the antenna cell with these drawings, which is good."""
    copytree(CONFIG / "connectors", folder / "connectors")
    (folder / "antenna-calibration").mkdir()
    if calibrated:
        copytree(CONFIG / "antenna-calibration", folder / "antenna-calibration", dirs_exist_ok=True)
    for name, old, new in changes:
        path = folder / "connectors" / f"{name}.toml"
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
    (folder / "antenna.toml").write_text((CONFIG / "antenna.toml").read_text(encoding="utf-8"))
    examined = examine_before_commissioning(folder / "antenna.toml")
    assert examined.errors == ()
    said: dict[str, str] = {}
    for one in examined.remarks:
        said[one.key] = f"{said.get(one.key, '')} {one.allowed}"
    return said


@pytest.mark.parametrize(
    ("pin_mm", "hole_mm", "times"), [("0.25", "0.28", "5 times"), ("1.0", "1.12", "1.3 times")]
)
def test_pins_that_no_usual_connector_has_at_this_distance(
    tmp_path: Path, pin_mm: str, hole_mm: str, times: str
) -> None:
    both = (
        (PINS, "diameter_mm = 0.5", f"diameter_mm = {pin_mm}"),
        (HOLES, "diameter_mm = 0.56", f"diameter_mm = {hole_mm}"),
    )
    said = remarks(tmp_path, both, calibrated=False)
    assert f"{times} as far as its pins are wide" in said["recipes.0.plug"]


@pytest.mark.parametrize(
    ("name", "old", "new", "key", "kinds"),
    [
        ("gripper", "= 2.0", "= 1.0", "recipes.0.gripper_marks", "plug_correction_1 and reference"),
        (ABOVE, "diameter_mm = 1.2", "diameter_mm = 0.6", f"{REFERENCE}.plate_above", "reference"),
        (BELOW, "diameter_mm = 1.2", "diameter_mm = 0.6", f"{REFERENCE}.plate_below", "reference"),
        (HOLES, "diameter_mm = 0.56", "diameter_mm = 0.6", "recipes.0.socket", "plug_correction_1"),
    ],
)
def test_a_drawing_with_which_nothing_stored_was_taught(
    tmp_path: Path, name: str, old: str, new: str, key: str, kinds: str
) -> None:
    said = remarks(tmp_path, [(name, old, new)])
    assert f"with which the stored {kinds} was taught" in said[key]
    assert "F563" in said[key]


def test_in_a_new_cell_the_two_sides_of_the_plate_tell_a_radius(tmp_path: Path) -> None:
    halved = [(BELOW, "diameter_mm = 1.2", "diameter_mm = 0.6")]
    said = remarks(tmp_path, halved, calibrated=False)
    assert "plate_above has diameter_mm = 1.2, this one 0.6" in said[f"{REFERENCE}.plate_below"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[3.0, -1.4]", "[5.0, -1.4]", "nearer to each other or farther apart"),
        ('"D3"', '"E3"', "plate_above has the dots D1, D2, D3, D4, D5, this one D1, D2, E3"),
    ],
)
def test_dots_that_lie_elsewhere_or_are_called_otherwise_from_below(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    said = remarks(tmp_path, [(BELOW, old, new)], calibrated=False)
    assert words in said[f"{REFERENCE}.plate_below"]


def test_the_shipped_drawings_are_those_of_the_shipped_calibrations(tmp_path: Path) -> None:
    assert remarks(tmp_path, []) == {}


@pytest.mark.parametrize("per_mm", [1e-3, 1 / 25.4])
@pytest.mark.parametrize(
    ("name", "key"),
    [("module-top", "recipes.0.module_top"), (ABOVE, f"{REFERENCE}.plate_above")],
)
def test_marks_in_metres_or_inches_are_refused(
    tmp_path: Path, name: str, key: str, per_mm: float
) -> None:
    copytree(CONFIG / "connectors", tmp_path / "connectors")
    path = tmp_path / "connectors" / f"{name}.toml"
    text = path.read_text(encoding="utf-8")
    other = re.sub(r"-?\d+\.\d+", lambda found: f"{float(found[0]) * per_mm:.6f}", text)
    path.write_text(other, encoding="utf-8")
    (tmp_path / "antenna.toml").write_text((CONFIG / "antenna.toml").read_text(encoding="utf-8"))
    (tmp_path / "antenna-calibration").mkdir()
    (issue,) = examine_before_commissioning(tmp_path / "antenna.toml").errors
    assert issue.key == key
    assert "in metres or inches" in issue.allowed


def test_an_insulator_that_is_far_larger_than_its_contacts_need(tmp_path: Path) -> None:
    ten_times = [(HOLES, "outline_mm = [12.0, 3.9]", "outline_mm = [120.0, 39.0]")]
    said = remarks(tmp_path, ten_times, calibrated=False)
    assert "times as wide as its contacts with what they span" in said["recipes.0.socket"]


def test_good_contacts_that_do_not_find_their_holes_are_refused(tmp_path: Path) -> None:
    copytree(CONFIG / "connectors", tmp_path / "connectors")
    for name in (PINS, HOLES):
        path = tmp_path / "connectors" / f"{name}.toml"
        text = path.read_text(encoding="utf-8")
        wide = text.replace("true_position_mm = 0.010", "true_position_mm = 0.1")
        path.write_text(wide, encoding="utf-8")
    (tmp_path / "antenna.toml").write_text((CONFIG / "antenna.toml").read_text(encoding="utf-8"))
    (tmp_path / "antenna-calibration").mkdir()
    (issue,) = examine_before_commissioning(tmp_path / "antenna.toml").errors
    assert issue.key == "recipes.0.plug"
    assert "here 0.42 mm, are less than capture_mm = 0.2" in issue.allowed
