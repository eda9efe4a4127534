"""A slide over the face of a plug, on streamed contact with an elastic part that has a chamfer."""

import asyncio

import numpy as np

from cellctl.processes.peg_in_hole.search.edges import slide_to_edge
from tests.unit.processes.peg_in_hole.search.test_probe import (
    greatest_n,
    hole,
    probe_in,
    standing_in,
)

FAR_RIM_M = 30e-3
_SEARCH_RATIO = 1.5
"""Multiple of the search force that a contact of a search may reach (R3 of the study)."""


def test_a_slide_lets_the_peg_go_at_a_flank_before_the_force_adds_up() -> None:
    # The press of the touch has brought the peg onto the chamfer: nothing tells of a lost face, and
    # a slide away from the hole draws it up the flank.
    world = standing_in(hole(1e5, 0.5), at_m=(0.3e-3, 0.0, 0.24e-3))
    probe = probe_in(world, 1e5, 0.5)
    edge = asyncio.run(slide_to_edge(probe, np.array([1.0, 0.0]), FAR_RIM_M))
    # Without that the slide goes on over the hole, and the flank pushes with 22 N.
    assert edge is not None
    assert edge.entered
    assert greatest_n(world) < _SEARCH_RATIO * probe.press_n
