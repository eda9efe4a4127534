import numpy as np
import pytest

from cellctl.cell.contact_motion.motions import ContactSample
from cellctl.processes.peg_in_hole.search.conditions import Bottomed


def carried(force_n: float) -> ContactSample:
    force = np.array([0.0, 0.0, -force_n])
    return ContactSample(0.0, np.zeros(3), np.zeros(3), force, np.zeros(3), 0.05)


@pytest.mark.parametrize(
    ("forces_n", "held"),
    [
        # Down a flank, and up the next one, which the arm feels before it is pressed more.
        ((6.0, 4.0, 3.0, 3.5, 4.2), [False, False, False, False, True]),
        # From the climb that ended before, downhill and along the bottom.
        ((9.0, 6.5, 5.9, 6.1, 6.3), [False] * 5),
    ],
)
def test_the_bottom_of_a_valley_is_known_by_what_carries_the_peg(
    forces_n: tuple[float, ...], held: list[bool]
) -> None:
    bottomed = Bottomed()
    assert [bottomed(carried(force_n)) for force_n in forces_n] == held
