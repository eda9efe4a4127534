"""The right triangle on the rim of a plug: the patent, as printed and corrected.

Three points of the circle on which the peg leaves the face, two chords at right angles: the
hypotenuse is a diameter. As printed the first direction is free and the centre is the midpoint of
the hypotenuse. Corrected, the vertex lies at 45 degrees to the centre and the centre is that of the
circle through all three points, which errors of the right angle and a common overshoot do not move
(section 1 of the reference on forces).
"""

from math import pi
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.circles import circle_through, turned
from cellctl.processes.peg_in_hole.search.edges import Edge, slide_to_edge, stand_inside
from cellctl.processes.peg_in_hole.search.probe import UPRIGHT, TouchProbe
from cellctl.processes.peg_in_hole.search.strategy import SearchStrategy

Array = NDArray[np.float64]

_WRONG_SIDE_M = 2e-3
"""A chord that ends so soon went out of the face, not across it."""
_LEAST_CHORD, _MOST_CHORD = 0.45, 0.9
"""Least and greatest chord over the diameter: with other chords an error of a point moves the
centre several times as far."""


class _EnteredOnTheWay(Exception):
    """A slide has crossed the hole by luck."""


class PatentMidpoint(SearchStrategy):
    """As printed."""

    name: ClassVar[SearchName] = SearchName.PATENT_MIDPOINT

    def __init__(self, direction_rad: float = 0.0) -> None:
        """The direction of the first chord from the first contact, which the patent leaves free."""
        self._direction = turned(np.array([1.0, 0.0]), direction_rad)

    async def find(self, probe: TouchProbe) -> bool:
        """Three edges, midpoint of the hypotenuse, then a small spiral."""
        try:
            centre_m = await self._centre(probe, probe.task.fit.rim_m or 0.0)
        except _EnteredOnTheWay:
            return True
        return centre_m is not None and await probe.look_round(centre_m)

    async def _centre(self, probe: TouchProbe, rim_m: float) -> Array | None:
        # The contracting spiral begins so wide that it covers the face, and touches there.
        start_m = np.array([probe.task.fit.outer_radius_m or 0.0, 0.0])
        first = await _edge(probe, start_m, self._direction, rim_m)
        second = await _edge(probe, start_m, -self._direction, rim_m)
        if first is None or second is None:
            return None
        inside_m = await stand_inside(probe, first.point_m, start_m)
        third = await _longer(probe, inside_m, turned(self._direction, pi / 2), rim_m)
        # The vertex of the right angle is the first point, so these two end the hypotenuse.
        return None if third is None else np.asarray((second.point_m + third.point_m) / 2)


class PatentCircumcentre(SearchStrategy):
    """Search by the circle through three points, with the vertex at 45 degrees to the centre."""

    name: ClassVar[SearchName] = SearchName.PATENT_CIRCUMCENTRE

    async def find(self, probe: TouchProbe) -> bool:
        """Three edges, their circle, then a small spiral."""
        try:
            centre_m = await self._centre(probe, probe.task.fit.rim_m or 0.0)
        except _EnteredOnTheWay:
            return True
        return centre_m is not None and await probe.look_round(centre_m)

    async def _centre(self, probe: TouchProbe, rim_m: float) -> Array | None:
        start_m = np.zeros(2)
        first = await _edge(probe, start_m, np.array([1.0, 0.0]), rim_m)
        if first is None:
            return None
        # The hole is known to within its uncertainty, so the chord at 45 degrees can be aimed.
        inwards = (start_m - first.point_m) / np.linalg.norm(start_m - first.point_m)
        inside_m = await stand_inside(probe, first.point_m, start_m)
        second = await _edge(probe, inside_m, turned(inwards, pi / 4), rim_m)
        third = await _edge(probe, inside_m, turned(inwards, -pi / 4), rim_m)
        if second is None or third is None:
            return None
        chords = (second.length_m / (2 * rim_m), third.length_m / (2 * rim_m))
        # Better no centre than one that a small error of a point has moved far.
        if not all(_LEAST_CHORD < chord < _MOST_CHORD for chord in chords):
            return None
        points = np.stack([edge.point_m for edge in (first, second, third)])
        return circle_through(points)[0]


async def _edge(probe: TouchProbe, from_m: Array, direction: Array, rim_m: float) -> Edge | None:
    await probe.touch_down(from_m, UPRIGHT)
    edge = await slide_to_edge(probe, direction, rim_m)
    if edge is not None and edge.entered:
        raise _EnteredOnTheWay
    return edge


async def _longer(probe: TouchProbe, from_m: Array, direction: Array, rim_m: float) -> Edge | None:
    """The edge across the face: of both directions the one that does not leave it at once."""
    for way in (direction, -direction):
        edge = await _edge(probe, from_m, way, rim_m)
        if edge is not None and edge.length_m > _WRONG_SIDE_M:
            return edge
    return None
