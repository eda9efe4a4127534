"""A slide over the face of a plug, on streamed contact with an elastic part that has a chamfer."""

import asyncio

import numpy as np

from cellctl.processes.peg_in_hole.search.edges import slide_to_edge
from tests.unit.cell.contact_motion.elastic_world import ElasticWorld
from tests.unit.processes.peg_in_hole.search.test_probe import (
    greatest_n,
    hole,
    probe_in,
    standing_in,
)

FAR_RIM_M = 30e-3


def slid_up_a_flank() -> tuple[ElasticWorld, float, bool]:
    # The press of the touch has brought the peg onto the chamfer: nothing tells of a lost face, and
    # a slide away from the hole draws it up the flank.
    world = standing_in(hole(1e5, 0.5), at_m=(0.3e-3, 0.0, 0.24e-3))
    probe = probe_in(world, 1e5, 0.5)
    edge = asyncio.run(slide_to_edge(probe, np.array([1.0, 0.0]), FAR_RIM_M))
    return world, probe.press_n, edge is not None and edge.entered


def test_a_slide_lets_the_peg_go_at_a_flank_before_the_force_adds_up() -> None:
    world, press_n, entered = slid_up_a_flank()
    assert entered
    assert greatest_n(world) < 1.2 * press_n
