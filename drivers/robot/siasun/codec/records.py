"""The records that an SJL/1 controller sends, as values.

Poses stay as they are sent here, plain floats: x, y, z in mm, a, b, c in degrees in the order that
the hello names.
"""

from dataclasses import dataclass

from cellctl.geometry.euler_order import EulerOrder
from drivers.robot.siasun.codec.angles import EULER_ORDERS

COMPACT_VERSION = "2"
"""Version of the form for slow job interpreters (docs/protocols/sjl-2.md)."""
REPORT_COUNTS = 500_000_000
"""Reports, and milliseconds, after which a job begins to count anew. A report contains the sum of
its numbers, which has to fit into 32 bits."""
Six = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class StreamFigures:
    """What a stream may at most do: in one tick, from its beginning, and without a setpoint."""

    step_mm: float
    step_deg: float
    travel_mm: float
    travel_deg: float
    loss_ms: int


@dataclass(frozen=True, slots=True)
class StreamOption:
    """What a job program offers for streamed motion."""

    period_ms: int
    figures: StreamFigures


@dataclass(frozen=True, slots=True)
class Hello:
    """Opens a channel. A version that is not known leaves the other fields empty."""

    version: str
    channel: str = ""
    robot: str = ""
    job_version: str = ""
    euler: str = ""
    unit: str = ""
    step_max_mm: float = 0.0
    deadman_ms: int = 0
    stream: StreamOption | None = None
    """What the job program says of streaming; None when it cannot stream."""
    acceleration_max_mm_s2: float = 0.0
    """What 100 percent of acceleration mean, of a job program that takes percents."""

    @property
    def euler_order(self) -> EulerOrder:
        """How its poses hold angles; a hello that was accepted names an order that is known."""
        return EULER_ORDERS[self.euler]

    @property
    def compact(self) -> bool:
        """The job program speaks the form for slow interpreters."""
        return self.version == COMPACT_VERSION


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
    """The command is refused, and nothing has moved."""

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

    def follows(self, last: "Status") -> bool:
        """Whether it moves on from an earlier report of the same session: a later number, which may
        have begun anew, and another time. A job that hangs in a loop sends the same one for ever,
        and by its time of arrival that would look fresh."""
        ahead = (self.count - last.count) % REPORT_COUNTS
        return 0 < ahead < REPORT_COUNTS // 2 and self.robot_ms != last.robot_ms


@dataclass(frozen=True, slots=True)
class StopDone:
    """Standing still and latched after ABORT number ``id``."""

    id: int
    flange_xyzabc: Six


@dataclass(frozen=True, slots=True)
class Tick:
    """One tick of a stream."""

    number: int
    robot_ms: int
    set_number: int
    """The newest setpoint that the robot has taken; 0 before the first."""
    late: int
    lost: int
    flange_xyzabc: Six


Record = Hello | Ack | Done | Rejected | Aborted | Duplicate | Status | StopDone | Tick
Answer = Ack | Done | Rejected | Aborted | Duplicate
