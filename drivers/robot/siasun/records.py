"""What an SJL/1 controller says, as values.

Poses stay in their written form here: X, Y, Z in mm, A, B, C in degrees, plain floats.
"""

from dataclasses import dataclass

Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Hello:
    """Opens a channel. ``version`` other than 1 leaves the other fields empty."""

    version: str
    channel: str = ""
    robot: str = ""
    job_version: str = ""
    euler: str = ""
    unit: str = ""
    step_max_mm: float = 0.0
    deadman_ms: int = 0


@dataclass(frozen=True, slots=True)
class Ack:
    """Command accepted."""

    seq: int


@dataclass(frozen=True, slots=True)
class Done:
    """Standing still at the target."""

    seq: int
    flange_xyzabc: Six


@dataclass(frozen=True, slots=True)
class Rejected:
    """Not accepted, nothing moved."""

    seq: int
    reason: str


@dataclass(frozen=True, slots=True)
class Aborted:
    """Accepted, then stopped short; standing still."""

    seq: int
    reason: str
    flange_xyzabc: Six


@dataclass(frozen=True, slots=True)
class Duplicate:
    """The sequence number was already taken."""

    seq: int


@dataclass(frozen=True, slots=True)
class Status:
    """The robot's state, every 20 ms."""

    count: int
    robot_ms: int
    mode: str
    emergency_stop: bool
    drives_on: bool
    moving: bool
    latched: bool
    error_code: int
    override_percent: int
    flange_xyzabc: Six
    joints_deg: Six


@dataclass(frozen=True, slots=True)
class StopDone:
    """Standing still and latched after ABORT number ``id``."""

    id: int
    flange_xyzabc: Six


Record = Hello | Ack | Done | Rejected | Aborted | Duplicate | Status | StopDone
Answer = Ack | Done | Rejected | Aborted | Duplicate
