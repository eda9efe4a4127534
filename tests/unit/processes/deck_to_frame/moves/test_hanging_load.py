"""Accelerations of the flange, chosen by how far the deck goes that hangs below it."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.processes.deck_to_frame.moves.hanging_load import (
    SLOWEST_SHARE,
    flange_acceleration_m_s2,
)

DECK_BELOW = RigidTransform.from_translation([0.0, 0.0, 0.5])
START = RigidTransform.from_translation([1.9, 0.0, 0.9])


def turned(turn_rad: float, shift_m: float = 0.0) -> RigidTransform:
    turn = Rotation.from_rotvec([turn_rad, 0.0, 0.0])
    return START * RigidTransform.from_components([0.0, shift_m, 0.0], turn)


@pytest.mark.parametrize(
    ("target", "share"),
    [
        (turned(0.0, 2e-3), 1.0),
        # Moved 2 mm one way, and the deck 1 mm back by the turn: the flange goes farthest.
        (turned(2e-3, 2e-3), 1.0),
        (turned(-4e-5, 2e-5), 0.5),
        (turned(1e-3), SLOWEST_SHARE),
        (START, 1.0),
    ],
)
def test_no_part_of_the_load_is_accelerated_more(target: RigidTransform, share: float) -> None:
    found = flange_acceleration_m_s2(START, target, DECK_BELOW, 0.02)
    assert found == pytest.approx(0.02 * share, rel=1e-3)
    ways_m = [
        float(np.linalg.norm((target * at).translation - (START * at).translation))
        for at in (RigidTransform.identity(), DECK_BELOW)
    ]
    if share > SLOWEST_SHARE and ways_m[0] > 0:
        assert found * ways_m[1] / ways_m[0] <= 0.02 * (1 + 1e-6)
