"""Which other values of a key are less safe, as its model says."""

from pathlib import Path

import pytest

from cellctl.config import load_cell
from cellctl.config.base import LessSafe
from cellctl.config.checks.bounds.less_safe import less_safe

MORE, LESS = LessSafe.WITH_MORE, LessSafe.WITH_LESS
PIN = Path("config/insertion-pin.toml")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("recipes.0.forces.search_n", MORE),
        ("recipes.0.base_T_hole.uncertainty_mm", LESS),
        ("processes.peg-in-hole.stiffness_n_mm", LESS),
        ("force_sensors.force.stale_ms", MORE),
    ],
)
def test_a_key_says_it_in_its_model(name: str, said: LessSafe) -> None:
    cell = load_cell(PIN)
    assert less_safe(cell, cell.recipes[0], "recipes.0", name) is said


@pytest.mark.parametrize("name", ["recipes.0.seat.grip_n", "processes.peg-in-hole.lost_tick_ms"])
def test_a_key_that_may_be_left_out_says_it_too(name: str) -> None:
    cell = load_cell(PIN)
    assert less_safe(cell, cell.recipes[0], "recipes.0", name) is MORE


@pytest.mark.parametrize(
    "name",
    [
        "recipes.0.fit.clearance_mm",
        "force_sensors.force.settings.rate_hz",
        "force_sensors.force",
        "recipes.0.no_such_key",
        "recipes.0.no_such_table.no_such_key",
    ],
)
def test_a_key_without_a_mark_and_what_is_no_key_say_nothing(name: str) -> None:
    cell = load_cell(PIN)
    assert less_safe(cell, cell.recipes[0], "recipes.0", name) is None
