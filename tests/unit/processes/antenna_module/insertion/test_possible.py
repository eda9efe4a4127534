"""Curves whose numbers are in other units, signs or axes than the columns say."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid
from cellctl.processes.antenna_module.insertion.possible import (
    require_possible_curve,
    unknown_zero,
)
from tests.rigs.antenna.curves import Shape, curve

SOCKET = read_connector(Path("config/connectors/micro-d-15-holes.toml"))


@pytest.mark.parametrize(
    "shape",
    [
        Shape(),
        Shape(peak_n=6.0),
        Shape(drift_n=-0.2),
        Shape(noise_n=0.5),
        Shape(pin_n_per_mm=115, pin_mm=(-4.4, 0.5)),
        Shape(side_n=6, axial_per_side=0.8),
        Shape(end_n=0.3),
    ],
)
def test_good_and_bad_pluggings_are_judged(shape: Shape) -> None:
    require_possible_curve(curve(shape), SOCKET)


def test_a_plug_that_is_drawn_out_again_is_judged() -> None:
    there = curve()
    back = slice(None, None, -1)
    whole = replace(
        there,
        t_s=np.concatenate([there.t_s, there.t_s[-1] + 0.004 + there.t_s]),
        depth_m=np.concatenate([there.depth_m, there.depth_m[back]]),
        force_n=np.concatenate([there.force_n, -2.0 * there.force_n[back]]),
        moment_n_m=np.concatenate([there.moment_n_m, there.moment_n_m[back]]),
    )
    require_possible_curve(whole, SOCKET)


def test_a_sign_is_named() -> None:
    good = curve()
    with pytest.raises(InsertionCurveInvalid, match=r"fz_n falls to -3\d.* on the way in"):
        require_possible_curve(replace(good, force_n=-good.force_n), SOCKET)
    with pytest.raises(InsertionCurveInvalid, match=r"z_mm falls from 1 to -2\.5.*another sign"):
        require_possible_curve(replace(good, depth_m=-good.depth_m), SOCKET)


@pytest.mark.parametrize(("part", "column"), [("force_n", "fx_n"), ("moment_n_m", "mx_n_m")])
def test_a_component_that_was_not_read_judges_nothing(part: str, column: str) -> None:
    """A side force of zeros had passed: a part that stands askew shows there."""
    good = curve()
    values = getattr(good, part).copy()
    values[:, 0] = 0.0
    with pytest.raises(InsertionCurveInvalid, match=rf"{column} is 0 in all \d+ samples"):
        require_possible_curve(replace(good, **{part: values}), SOCKET)


def test_moments_about_the_sensor_are_named() -> None:
    good = curve()
    lever_m = np.array([0.03, 0.0, 0.0])
    moment = good.moment_n_m + np.cross(lever_m, good.force_n)
    with pytest.raises(InsertionCurveInvalid, match=r"30\.\d mm beside the middle.* 12\.6 mm acro"):
        require_possible_curve(replace(good, moment_n_m=moment), SOCKET)


@pytest.mark.parametrize(
    ("part", "column", "name", "off"),
    [
        ("force_n", 2, "fz_n", -3.0),
        ("force_n", 2, "fz_n", 0.6),
        ("force_n", 2, "fz_n", -12.0),
        ("force_n", 0, "fx_n", 0.6),
        ("force_n", 1, "fy_n", -0.6),
        ("moment_n_m", 0, "mx_n_m", 0.005),
        ("moment_n_m", 0, "mx_n_m", -0.005),
        ("moment_n_m", 1, "my_n_m", 0.005),
        ("moment_n_m", 2, "mz_n_m", 0.005),
        ("moment_n_m", 2, "mz_n_m", -0.005),
    ],
)
def test_a_curve_that_was_not_tared_is_named(part: str, column: int, name: str, off: float) -> None:
    """A zero that is off hides a pin that stands on the face, or lets a moment point elsewhere."""
    good = curve()
    values = getattr(good, part).copy()
    values[:, column] += off
    unit = {"force_n": "N", "moment_n_m": "N·m"}[part]
    with pytest.raises(
        InsertionCurveInvalid, match=rf"{name} is .* {unit} in the mean.* without a tare"
    ):
        require_possible_curve(replace(good, **{part: values}), SOCKET)


def test_a_curve_that_begins_at_the_touch_shows_no_zero() -> None:
    good = curve()
    assert unknown_zero(good, SOCKET) is None
    late = good.after(float(good.t_s[good.depth_m < -0.4e-3][-1]))
    require_possible_curve(late, SOCKET)
    assert unknown_zero(late, SOCKET) is not None
