"""What helps a peg that stands short of its seat: each measure once, none with more force.

Source: section 5.3 of the study of insertion by touch.
"""

from abc import ABC, abstractmethod
from math import pi, radians
from typing import ClassVar

import numpy as np

from cellctl.cell.contact_motion.motions import ContactMotions
from cellctl.geometry.pose import Array
from cellctl.processes.peg_in_hole.insertion.felt import Standing
from cellctl.processes.peg_in_hole.plan.task import FitGeometry
from cellctl.processes.peg_in_hole.search.conditions import LostSupport

_LOWERED, _HALVED = 0.3, 0.5
"""Share of the force at which the peg stands with which it is pressed while it gives way, and while
it is wiggled or turned."""
_GIVE_WAY_S = 1.0
"""Time for side force and moments to fall to nothing."""
_WIGGLE_RAD, _WIGGLE_HZ, _WIGGLE_POINTS = radians(0.3), 2.0, 8
"""Greatest tilt and frequency of the wiggle, and the corners of its circle."""
_YAW_RAD, _YAW_RAD_S = radians(2), radians(3)
"""Turn to either side, and its speed, which is that of the sweep for a keyway."""
_BACK_M = 1e-3
"""Way back before the second entry."""


def _upright(standing: Standing) -> Array:
    """The attitude without tilt, at the angle at which the part stands."""
    return np.array([0.0, 0.0, standing.yaw_rad])


def yaw_rad(fit: FitGeometry) -> float:
    """How far ``Yaw`` turns to either side; a keyed plug by its play only."""
    return _YAW_RAD if fit.keys is None else min(_YAW_RAD, fit.keys.window_rad)


class Recovery(ABC):
    """One measure."""

    name: ClassVar[str]

    @abstractmethod
    async def apply(self, motions: ContactMotions, fit: FitGeometry, standing: Standing) -> None:
        """Ends with the peg upright in the hole, ready to be fed again."""


class GiveWay(Recovery):
    """Lower the feed and null side force and moments."""

    name: ClassVar[str] = "give way"

    async def apply(
        self,
        motions: ContactMotions,
        fit: FitGeometry,  # noqa: ARG002 - alike for every fit
        standing: Standing,
    ) -> None:
        """One second at 30 % of the force at which it stands, or until it is free."""
        press_n = _LOWERED * standing.axial_n
        # A peg that comes free sinks, and nothing carries it: that is what is hoped for.
        await motions.comply(press_n, _GIVE_WAY_S, LostSupport(press_n))


class Wiggle(Recovery):
    """Tilt in a circle, by less than the clearance allows."""

    name: ClassVar[str] = "wiggle"

    async def apply(self, motions: ContactMotions, fit: FitGeometry, standing: Standing) -> None:
        """One turn of the axis at 50 % of the force."""
        amplitude = min(_WIGGLE_RAD, fit.clearance_m / max(standing.depth_m, 1e-3))
        hold = np.array([0.0, 0.0, _HALVED * standing.axial_n])
        speed = 2 * pi * _WIGGLE_HZ * amplitude
        for angle in np.linspace(0, 2 * pi, _WIGGLE_POINTS):
            tilted = amplitude * np.array([np.cos(angle), np.sin(angle), 0.0])
            await motions.turn(tilted + _upright(standing), hold, speed)
        await motions.turn(_upright(standing), hold, speed)


class Yaw(Recovery):
    """Turn about the axis; friction then acts round the peg instead of along it."""

    name: ClassVar[str] = "yaw"

    async def apply(self, motions: ContactMotions, fit: FitGeometry, standing: Standing) -> None:
        """Turn to both sides at 50 % of the force."""
        hold = np.array([0.0, 0.0, _HALVED * standing.axial_n])
        greatest = yaw_rad(fit)
        for angle in (greatest, -greatest, 0.0):
            turned = _upright(standing) + np.array([0.0, 0.0, angle])
            await motions.turn(turned, hold, _YAW_RAD_S)


class BackAndAgain(Recovery):
    """Back a little, null what is felt, and enter again."""

    name: ClassVar[str] = "back and again"

    async def apply(
        self,
        motions: ContactMotions,
        fit: FitGeometry,  # noqa: ARG002 - alike for every fit
        standing: Standing,
    ) -> None:
        """Back 1 mm, where nothing is below the peg to press against."""
        await motions.back_out(_BACK_M - standing.depth_m)
        await motions.comply(0.0, _GIVE_WAY_S)


IN_ORDER: tuple[Recovery, ...] = (GiveWay(), Wiggle(), Yaw(), BackAndAgain())
"""What is tried, in this order, with a peg that feels a side force or a moment."""
WHEN_STRAIGHT: tuple[Recovery, ...] = (BackAndAgain(),)
"""What is tried with one that meets a resistance without them: only a second entry tells chip from
closed hole."""
