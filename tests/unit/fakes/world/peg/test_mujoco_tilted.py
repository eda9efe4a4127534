"""Pegs without a chamfer that are tilted far, beside and over a tight hole, against MuJoCo.

The place and the way of the contact differ: the lowest point of the rim on the face, the rim across
the edge of the mouth on one side or on both, the wall on one side or on both.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fakes.world.frames import Array
from tests.unit.fakes.world.peg.judge import COMMANDED, DEPTH, F_X, F_Z, Push, X, Y
from tests.unit.fakes.world.peg.pushing import MM, pin

FIGURES = pytest.mark.figures

_PRESSES = (0.3, 0.55, 0.8)
"""Shares of the way after the first contact at which forces are compared."""
_FELT_N = 0.1


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


def _first_contact_m(rows: Array) -> float:
    """Commanded height without what springs have given by then, which is the height of the tip."""
    felt = np.linalg.norm(rows[:, F_X : F_Z + 1], axis=1) > _FELT_N
    return float(-rows[felt.argmax(), DEPTH])


def _at(rows: Array, height_m: float) -> Array:
    """The row of a commanded height."""
    downwards = -rows[:, COMMANDED]
    return np.array([np.interp(-height_m, downwards, column) for column in rows.T])


def _assert_alike(push: Push, to_m: float, *, rel: float, abs_n: float) -> None:
    """First contact, and then forces and place at three heights."""
    from_m = push.fit.peg_radius_m * np.sin(push.tilt_rad) + 0.02 * MM
    fake, judge = push.in_the_fake(from_m, to_m), push.in_mujoco(from_m, to_m)
    touches_m = _first_contact_m(judge)
    assert _first_contact_m(fake) == pytest.approx(touches_m, abs=0.01 * MM)
    for press in _PRESSES:
        height_m = touches_m + press * (to_m - touches_m)
        ours, theirs = (_at(rows, height_m) for rows in (fake, judge))
        close_n = max(abs_n, rel * float(np.linalg.norm(theirs[F_X : F_Z + 1])))
        assert ours[F_X : F_Z + 1] == pytest.approx(theirs[F_X : F_Z + 1], abs=close_n)
        assert ours[[X, Y, DEPTH]] == pytest.approx(theirs[[X, Y, DEPTH]], abs=0.01 * MM)


_SOFT = Push(
    pin(0.02, 0.0), 1e5, 50.0, 1e5, tilt_rad=float(np.deg2rad(8.0)),
    speed_m_s=4e-3, sectors=128, dt_s=2.5e-5,
)  # fmt: skip
_STIFF = replace(_SOFT, lateral_n_m=1e6, axial_n_m=1e6, speed_m_s=2e-3)
_WIDER = replace(_STIFF, fit=pin(0.05, 0.0), tilt_rad=float(np.deg2rad(5.0)))


@pytest.mark.parametrize(
    ("x_mm", "y_mm", "to_mm"),
    [
        pytest.param(0.2, 0.0, 0.22, id="in front, on its lowest point", marks=FIGURES),
        pytest.param(0.0, -0.5, 0.22, id="beside, next to its lowest point"),
        pytest.param(-0.2, 0.0, -0.23, id="behind, across the edge on both sides"),
        pytest.param(
            -1.0, 0.0, -0.14, id="far behind, across the edge on both sides", marks=FIGURES
        ),
        pytest.param(
            -0.35, 0.35, 0.12, id="behind and beside, across the edge on one side", marks=FIGURES
        ),
        pytest.param(-0.14, 0.14, 0.04, id="slides towards the mouth"),
        pytest.param(0.0, 0.06, 0.14, id="slides into the mouth from beside", marks=FIGURES),
        pytest.param(
            -0.06, 0.0, -0.38, id="goes into the mouth between both sides, and jams", marks=FIGURES
        ),
        pytest.param(0.03, 0.015, -0.2, id="goes in along the wall in front"),
        pytest.param(-0.03, 0.01, -0.38, id="goes in beside the middle, and jams"),
    ],
)
def test_by_place(x_mm: float, y_mm: float, to_mm: float) -> None:
    push = replace(_SOFT, x_m=x_mm * MM, y_m=y_mm * MM)
    _assert_alike(push, to_mm * MM, rel=0.1, abs_n=0.3)


@pytest.mark.parametrize(
    ("push", "x_mm", "y_mm", "to_mm"),
    [
        pytest.param(_STIFF, -0.2, 0.0, -0.06, id="behind", marks=FIGURES),
        pytest.param(_STIFF, -0.14, 0.14, 0.21, id="slides", marks=pytest.mark.long),
        pytest.param(_STIFF, 0.0, 0.03, 0.05, id="beside, along the wall"),
        pytest.param(_WIDER, -0.2, 0.0, -0.09, id="wider, behind"),
        pytest.param(_WIDER, 0.0, 0.06, 0.09, id="wider, beside", marks=pytest.mark.long),
        pytest.param(_WIDER, 0.03, 0.03, -0.05, id="wider, along the wall", marks=FIGURES),
    ],
)
def test_held_by_a_stiff_arm(push: Push, x_mm: float, y_mm: float, to_mm: float) -> None:
    _assert_alike(replace(push, x_m=x_mm * MM, y_m=y_mm * MM), to_mm * MM, rel=0.15, abs_n=0.3)
