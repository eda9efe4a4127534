"""Contacts inside a connector rub at a plug in its hole, and nowhere else."""

import pytest

from fakes.world.peg.fit import Fit
from fakes.world.peg.slots import among_contacts

FIT = Fit(14e-3, 14.15e-3, 10e-3, contact_forces=((6e-3, 0.0), (10e-3, 30.0)))


@pytest.mark.parametrize(
    ("x_m", "depth_m", "rubs"),
    [(0.0, 7e-3, True), (0.1e-3, 7e-3, True), (0.0, 5e-3, False), (36e-3, 9e-3, False)],
)
def test_beside_the_connector_nothing_rubs(x_m: float, depth_m: float, rubs: bool) -> None:
    assert among_contacts(FIT, (x_m, 0.0, -depth_m, 0.0, 0.0, 0.0)) is rubs


def test_a_plain_hole_has_none() -> None:
    assert not among_contacts(Fit(3e-3, 3.05e-3, 12e-3), (0.0, 0.0, -9e-3, 0.0, 0.0, 0.0))
