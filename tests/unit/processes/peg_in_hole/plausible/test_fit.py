"""Touches of the face that are farther out than the part needs."""

from pathlib import Path

import pytest

from cellctl.config.commissioning import examine_before_commissioning

CONFIG = Path(__file__).parents[5] / "config"
KEY = "recipes.0.base_T_hole.face_radius_mm"


def remarks_with(folder: Path, cell: str, old: str, new: str) -> dict[str, str]:
    """What is said beside a shipped cell with this replacement, by its keys."""
    name = f"insertion-{cell}"
    calibrations = folder / f"{name}-calibration"
    calibrations.symlink_to(CONFIG / calibrations.name)
    text = (CONFIG / f"{name}.toml").read_text(encoding="utf-8")
    assert old in text
    (folder / f"{name}.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    examined = examine_before_commissioning(folder / f"{name}.toml")
    assert examined.errors == ()
    return {one.key: one.allowed for one in examined.remarks}


@pytest.mark.parametrize(
    ("cell", "old", "new", "said"),
    [
        ("pin", "peg_radius_mm = 3.0", "peg_radius_mm = 1.5", "1.7 times the 4.65 mm"),
        ("pin", "face_radius_mm = 8.0", "face_radius_mm = 16.0", "2.1 times the 7.65 mm"),
        ("connector", "peg_radius_mm = 14.0", "peg_radius_mm = 7.0", "1.4 times the 25.6 mm"),
        ("connector", "face_radius_mm = 36.0", "face_radius_mm = 46.0", "1.4 times the 32.6 mm"),
    ],
)
def test_a_radius_that_is_half_or_a_diameter_is_remarked_on(
    tmp_path: Path, cell: str, old: str, new: str, said: str
) -> None:
    assert said in remarks_with(tmp_path, cell, old, new)[KEY]


@pytest.mark.parametrize("cell", ["pin", "connector"])
def test_nothing_is_said_of_the_shipped_cells(tmp_path: Path, cell: str) -> None:
    assert KEY not in remarks_with(tmp_path, cell, "face_radius_mm", "face_radius_mm")
