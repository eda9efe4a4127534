"""Pegs without a chamfer that are tilted far, beside and over a tight hole, against MuJoCo.

The place and the way of the contact differ: the lowest point of the rim on the face, the rim across
the edge of the mouth on one side or on both, the wall on one side or on both.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fakes.world.frames import Array
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg
from tests.unit.fakes.world.peg.judge import COMMANDED, DEPTH, F_X, F_Z, X, Y, Push
from tests.unit.fakes.world.peg.pushing import MM, arm, pin

_PRESSES = (0.3, 0.6, 0.9)
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
