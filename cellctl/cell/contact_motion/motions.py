"""What a search and an insertion by touch are made of.

Frame A ("task") has its origin at the search centre on the touched face, z into the hole. The tip
of the peg is the centre of its bottom circle, or of the plug's mating face. All motions are of the
tip, and all forces and moments are those that the environment exerts on the peg, taken at the tip.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class Ended(StrEnum):
    """Why a motion ended."""

    FORCE = "force"
    TRAVEL = "travel"
    TIME = "time"
    """The time of a press or of a compliant hold is over. No motion along a path ends like this:
    one that takes far too long raises ``StreamLate``."""
    CONDITION = "condition"
    """The caller's own condition held."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactSample:
    """State of the tip at one tick of the stream."""

    time_s: float
    """Monotonic time in seconds."""
    task_position_tip_m: Vector
    """(3,), by the controller's encoders, corrected by nothing."""
    task_rotation_tip_rad: Vector
    """(3,), rotation vector against the nominal attitude of the insertion."""
    force_n: Vector
    """(3,) in frame A, filtered as the control law sees it."""
    moment_n_m: Vector
    """(3,) in frame A, about the tip."""
    force_sigma_n: float
    """Standard deviation of one component of ``force_n``."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactMotion:
    """A motion that has come to its end; the stream stands and holds its place."""

    ended: Ended
    samples: tuple[ContactSample, ...]
    """The samples of the motion, at least one: where and how it ended."""

    @property
    def last(self) -> ContactSample:
        """State at the end."""
        return self.samples[-1]


Condition = Callable[[ContactSample], bool]


def never(_sample: ContactSample) -> bool:
    """A condition that never holds. A press that is given it may lose its contact without a
    fault."""
    return False


class ContactMotions(ABC):
    """Streamed motions of the tip. Used by one task at a time, within one stream.

    Every motion has bounds on force, way and time; a fault of stream, sensor or guard raises its
    own error and leaves the robot standing. Gains follow from the measured stiffness and dead time
    of the cell, never from the caller.
    """

    @abstractmethod
    async def move_free(
        self, task_position_tip_m: Vector, task_rotation_tip_rad: Vector, speed_m_s: float
    ) -> ContactMotion:
        """Go straight to a pose through free space.

        A force above the press of the search ends it by ``FORCE``: something stands in the way, or
        the motion began in a contact that it does not leave.
        """

    @abstractmethod
    async def touch(
        self,
        direction: Vector,
        travel_m: float,
        force_n: float,
        speed_m_s: float | None = None,
        until: Condition | None = None,
    ) -> ContactMotion:
        """Go along a unit vector until the force against it exceeds ``force_n``.

        Without a speed it takes the greatest that keeps the overshoot of the force within
        ``force_n``. A touch across z that follows a press keeps pressing along z.
        """

    @abstractmethod
    async def press(
        self, force_n: float, hold_s: float, until: Condition | None = None
    ) -> ContactMotion:
        """Follow the face with a force along z, held for a time; x, y and attitude stay."""

    @abstractmethod
    async def slide(
        self,
        way_m: Vector,
        press_n: float,
        speed_m_s: float,
        until: Condition,
        side_force_n: float,
    ) -> ContactMotion:
        """Pressed with a force along z, follow points (n, 2) in the plane of the face.

        Ends by the condition, by a force in the plane above ``side_force_n``, or at the last point.
        """

    @abstractmethod
    async def turn(
        self,
        task_rotation_tip_rad: Vector,
        hold_force_n: Vector,
        speed_rad_s: float,
        until: Condition | None = None,
    ) -> ContactMotion:
        """Turn about the tip to an attitude while forces (3,) are held; zero means stiff."""

    @abstractmethod
    async def comply(
        self,
        press_n: float,
        hold_s: float,
        until: Condition | None = None,
        *,
        turns: bool = True,
    ) -> ContactMotion:
        """Null the forces in the plane while pressed, and the moments; the tip moves freely.

        Without ``turns`` the attitude stays: on a chamfer, whose force passes beside the tip, a peg
        that may turn tips over instead of sliding down.
        """

    @abstractmethod
    async def feed(
        self,
        depth_m: float,
        force_limit_n: float,
        until: Condition | None = None,
        past_m: float = 0.0,
    ) -> ContactMotion:
        """Go into the hole to a depth below the face, giving way sideways and in attitude.

        The feed slows with the axial force and backs off above 60 % of the limit. It goes on for
        ``past_m`` beyond the depth, slowly as long as no force is felt. A feed that begins deeper
        than that ends where it stands.
        """

    @abstractmethod
    async def back_out(self, height_m: float) -> ContactMotion:
        """Lift to a height above the face along the way that the tip came."""
