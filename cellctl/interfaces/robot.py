"""A robot controller that moves its flange on command and says where it is."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.pose import Array
from cellctl.interfaces.arm_load import PendantSelection
from cellctl.interfaces.device import Device
from cellctl.interfaces.motion_bounds import MotionBounds

ForwardKinematics = Callable[[Array], RigidTransform]
"""``base_T_flange`` at joints, shape (6,), in rad."""


class RobotMode(Enum):
    """Operating mode on the controller's panel."""

    MANUAL = "manual"
    AUTOMATIC = "automatic"
    REMOTE = "remote"


@dataclass(frozen=True, slots=True, eq=False)
class RobotState:
    """What the controller last reported."""

    time_s: float
    """Monotonic time of receipt."""
    base_T_flange: RigidTransform
    joints_rad: Array
    """Shape (6,)."""
    mode: RobotMode
    emergency_stop: bool
    drives_on: bool
    moving: bool
    stop_latched: bool
    error_code: int
    """The vendor's number, 0 for none."""
    speed_override_ratio: float
    error_words: str = ""
    """The number with the vendor's text and what to do, as far as they are known; empty for 0."""
    unasked_latch: str = ""
    """Why a stop is latched for which nobody has asked this driver: a dead man, a link that was
    lost for a moment, a guard. Empty without such a latch, and while a motion runs, which tells its
    own end."""

    @property
    def ready(self) -> bool:
        """True when the controller would accept a motion now."""
        healthy = not (self.emergency_stop or self.stop_latched or self.error_code)
        return self.mode is RobotMode.REMOTE and self.drives_on and healthy

    def distance_to(self, base_T_flange: RigidTransform) -> tuple[float, float]:
        """Distance (m) and angle (rad) from the reported pose to another."""
        delta = self.base_T_flange.inv() * base_T_flange
        return float(np.linalg.norm(delta.translation)), float(delta.rotation.magnitude())


class Robot(Device):
    """Called by the steps of the state machine, from the daemon's event loop only.

    Connecting never moves the arm. A move returns after standstill at its target; leaving it
    early by cancellation stops the robot first. After ``stop`` every move raises ``NotRearmed``
    until ``rearm``. Nothing resumes by itself.

    Every method may raise ``LinkLost``, ``ReplyTimeout`` or ``ProtocolViolation``; moves also
    ``MotionRejected``, ``MotionAborted``, ``RobotNotReady``, ``NotRearmed``, ``TargetOutOfBounds``,
    ``WayNotReached``.
    """

    @classmethod
    def checks_joint_ways(cls, config: Any) -> bool:  # noqa: ARG003 - of use to drivers only
        """Whether, with these settings, joint moves are held against the bounds of the flange.

        ``config`` is an instance of the driver's ``Config``. `cellctl check` asks.
        """
        return False

    @classmethod
    def needs_permit(cls, config: Any) -> bool:  # noqa: ARG003
        """Whether only programs that somebody has loaded into the controller stop this arm when the
        link is lost: a real cell then needs a contact of the PC in the arm's permit loop.
        `cellctl check` asks."""
        return False

    @classmethod
    def check_joint_target(cls, config: Any, joints_rad: Array) -> None:
        """Raise ``TargetOutOfBounds`` when, with these settings, the arm may not stand there.

        ``joints_rad`` has shape (6,). `cellctl check` asks for every taught pose; a driver that
        does not know says nothing, and refuses the move itself.
        """

    @classmethod
    def bounds(cls, config: Any) -> MotionBounds:  # noqa: ARG003
        """What the driver refuses with these settings.

        `cellctl check` holds the speeds of the cell file and the places of recipes against it, so
        that a mistake is found before the first move.
        """
        return MotionBounds()

    @classmethod
    def forward_kinematics(cls, config: Any) -> ForwardKinematics | None:  # noqa: ARG003
        """Where the flange is at given joints; None where these settings do not say it."""
        return None

    @classmethod
    def chain(cls, config: Any) -> ArmChain | None:  # noqa: ARG003
        """The links of the arm and the limits of its joints; None where these settings do not say
        it."""
        return None

    @classmethod
    def published_reach_m(cls, config: Any) -> float | None:  # noqa: ARG003
        """From A1 to the middle of the wrist of the stretched arm, by its maker's data, in m; None
        where the settings name no model that the driver knows. `cellctl check` holds the table of
        links against it."""
        return None

    @abstractmethod
    async def disconnect(self) -> None:
        """Stop a running motion and drop the link. May be called in any state, twice too."""

    @abstractmethod
    def state(self, max_age_s: float = 0.25) -> RobotState:
        """The newest report; raises ``StaleData`` when it is older than ``max_age_s``."""

    def link_facts(self) -> dict[str, str]:
        """What the controller has said about itself when it connected: words by name, for people.

        Asked by `cellctl robot`; empty where a driver has nothing to say.
        """
        return {}

    def round_trips_s(self) -> tuple[float, ...]:
        """How long the newest questions or commands waited for their first answer, in s.

        Asked by `cellctl robot`; empty where a driver does not measure it, or had none yet.
        """
        return ()

    def least_acceleration_m_s2(self) -> float:
        """Smallest acceleration of a straight move that the controller can be told; 0: any.

        Asked while connected. Less is refused with ``TargetOutOfBounds`` and never replaced by
        more: a load that hangs on the arm would swing with it.
        """
        return 0.0

    async def selection(self) -> PendantSelection:
        """What is chosen at the pendant, asked now; nothing where the controller does not tell.

        A driver never changes it: a person selects load and frames.
        """
        return PendantSelection()

    @abstractmethod
    async def move_joint(self, joints_rad: Array, *, speed_ratio: float) -> RobotState:
        """Joint motion to shape (6,) at a ratio (0, 1] of the rated speed.

        A ratio and not rad/s, because controllers take the speed of a joint move as a percentage.
        """

    @abstractmethod
    async def move_linear(
        self, base_T_flange: RigidTransform, *, speed_m_s: float, acceleration_m_s2: float
    ) -> RobotState:
        """Straight motion of the flange to a pose in the robot base."""

    @abstractmethod
    async def step(self, base_T_flange: RigidTransform, *, speed_m_s: float) -> RobotState:
        """A short, never blended move; more than the step limit of controller or driver is refused.

        Contact is approached by steps, because the force is judged at standstill between them: a
        step that has ended cannot run on, however late a stop would take effect, so that the way
        beyond a contact is at most one step.
        """

    @abstractmethod
    async def stop(self) -> None:
        """Stop and latch; returns after standstill, else raises ``StopFailed``.

        A robot that has not confirmed its stop gets no further sign of life: no heartbeat, and no
        link that it could take for one, until ``connect``. Its latch stays through that.
        """

    @abstractmethod
    async def rearm(self) -> None:
        """Release the latch of a stop. Never moves."""
