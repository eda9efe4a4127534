"""Figures against their limits, in words."""

import json
from dataclasses import replace
from math import nan
from pathlib import Path

import pytest

from cellctl.calibration.checks import LimitCheck, checks_from_record

SHIPPED = sorted(Path("config").glob("*-calibration/*.json"))


@pytest.mark.parametrize(
    ("check", "words"),
    [
        (LimitCheck("residual", 0.2, 0.3, "mm"), "residual 0.2 mm (≤ 0.3): ok"),
        (LimitCheck("views", 3, 20, "", "min"), "views 3 (≥ 20): OUT OF LIMIT"),
        (LimitCheck("seat force", nan, 5, "N", "min"), "seat force not measured (≥ 5 N)"),
        (
            LimitCheck("inclination", -0.2, 0.5, "°", "both"),
            "inclination -0.2 ° (within ± 0.5): ok",
        ),
        (LimitCheck("mass", -3.0, 2, "%", "both"), "mass -3 % (within ± 2): OUT OF LIMIT"),
        (LimitCheck("views", nan, 20, "", "min"), "views not measured (≥ 20)"),
    ],
)
def test_a_check_in_words(check: LimitCheck, words: str) -> None:
    assert str(check) == words


def test_a_limit_of_the_magnitude_refuses_on_both_sides_and_what_is_no_number() -> None:
    inside = LimitCheck("inclination", -0.5, 0.5, "°", "both")
    assert inside.passed
    assert [replace(inside, value=value).passed for value in (0.51, -0.51, nan)] == [False] * 3


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: f"{file.parent.name}/{file.stem}")
def test_figures_of_every_kind_of_calibration_can_be_read(file: Path) -> None:
    """A run of a procedure records them as its own: one that cannot be read would end it."""
    written = json.loads(file.read_text(encoding="utf-8"))["record"]["checks"]
    read = checks_from_record(written)
    assert [(one.name, one.passed) for one in read] == [(one["name"], True) for one in written]


def test_a_limit_without_a_side_is_one_of_the_magnitude_and_a_side_that_is_none_is_refused() -> (
    None
):
    record = LimitCheck("mass against CAD", -1.0, 2.0, "%", "both").to_record()
    (read,) = checks_from_record([{key: value for key, value in record.items() if key != "side"}])
    assert read == LimitCheck("mass against CAD", -1.0, 2.0, "%", "both")
    with pytest.raises(ValueError, match="left"):
        checks_from_record([{**record, "side": "left"}])
