"""The settings of a SIASUN robot in the cell file. mm, degrees, mm/s, seconds."""

from ipaddress import ip_address, ip_network
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drivers.robot.siasun.controller_errors import ErrorList

Port = Annotated[int, Field(ge=1, le=65535)]
Seconds = Annotated[float, Field(gt=0.0, le=600.0)]
Point = tuple[float, float, float]
Joints = tuple[float, float, float, float, float, float]
Row = tuple[float, float, float, float]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    listen_host: str = "127.0.0.1"
    """Address of this PC that the job programs connect to."""
    robot_name: Annotated[str, Field(pattern=r"^[A-Z0-9_-]{1,16}$", examples=["SR500A"])]
    """The name the controller must give in its hello."""
    robot_address: str = ""
    """Address of the controller, or a network; others are refused. Not needed on loopback."""
    connect_timeout_s: Seconds = 10.0
    """Longest wait for the job programs of the robot, which call this PC every half second."""
    max_deadman_s: Seconds = 0.5
    """A job program that would keep moving longer than this without a heartbeat is refused."""

    @model_validator(mode="after")
    def _robot_is_known(self) -> Self:
        if self.robot_address:
            # Only parsed here, so that a wrong address is found by ``cellctl check`` and not when
            # the robot calls.
            ip_network(self.robot_address, strict=False)
        elif not _is_loopback(self.listen_host):
            # The protocol has no password, so a name alone would let anybody be the robot.
            raise ValueError(f"robot_address is needed when listening on {self.listen_host}")
        return self


class MotionLimits(BaseModel):
    """Bounds of every target of one arm, whatever its controller speaks."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    workspace_min_mm: Point
    workspace_max_mm: Point
    """Corners of the box, in the robot base, that the flange must stay in."""
    joints_min_deg: Joints
    joints_max_deg: Joints
    """What a joint move may ask for, and with a dh table what a straight move may need on its way;
    at most the robot's own range."""
    dh: tuple[Row, Row, Row, Row, Row, Row] | None = None
    """Standard Denavit-Hartenberg table, base to flange: offset of the angle (deg), d (mm), a (mm),
    alpha (deg) of each joint. Without it no way is checked."""
    joint_workspace_min_mm: Point | None = None
    """Corners of a wider box for the flange in joint moves; None: that of all other moves."""
    joint_workspace_max_mm: Point | None = None
    max_speed_mm_s: Annotated[float, Field(gt=0.0, le=2000.0)]
    """Greatest speed of the flange on a straight way; a faster move is refused."""
    max_acceleration_mm_s2: Annotated[float, Field(gt=0.0, le=5000.0)] = 1000.0
    """Greatest acceleration of a straight move."""
    max_joint_speed_percent: Annotated[int, Field(ge=1, le=100)] = 25
    """Greatest speed of a joint move, as a share of the rated speed of each joint. It is low
    as long as the cell file states no other."""
    max_step_mm: Annotated[float, Field(gt=0.0, le=10.0)] = 0.5
    """Longest single step in contact. The job programs offer as much (STEPMAX in
    docs/protocols/sjl-1.md); the lesser of both counts."""
    max_stream_step_mm: Annotated[float, Field(gt=0.0, le=2.0)] = 0.1
    """Greatest way of a streamed setpoint in one tick of the controller."""
    max_stream_step_deg: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    """Greatest turn of a streamed setpoint in one tick of the controller."""
    max_stream_travel_mm: Annotated[float, Field(gt=0.0, le=200.0)] = 30.0
    """Greatest distance of a streamed setpoint from where the stream began."""
    max_stream_travel_deg: Annotated[float, Field(gt=0.0, le=30.0)] = 5.0
    """Greatest turn of a streamed setpoint against where the stream began."""
    max_stream_loss_s: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """Longest time without a setpoint or without a tick before a stream must end."""
    arrival_tolerance_mm: Annotated[float, Field(gt=0.0, le=10.0)] = 0.5
    """A motion that reports its end farther from its target than this has failed."""
    arrival_tolerance_deg: Annotated[float, Field(gt=0.0, le=10.0)] = 0.1
    """The same for the angle of the flange, and for every joint."""

    @property
    def joint_workspace_mm(self) -> tuple[Point, Point]:
        """Lower and upper corner of the box for joint moves."""
        lower = self.joint_workspace_min_mm or self.workspace_min_mm
        return lower, self.joint_workspace_max_mm or self.workspace_max_mm

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        pairs = {
            "workspace_min_mm": (self.workspace_min_mm, self.workspace_max_mm),
            "joints_min_deg": (self.joints_min_deg, self.joints_max_deg),
            "joint_workspace_min_mm": self.joint_workspace_mm,
        }
        for key, (lower, upper) in pairs.items():
            if not all(low < high for low, high in zip(lower, upper, strict=True)):
                raise ValueError(
                    f"{key} must lie below {key.replace('min', 'max')} in every component"
                )
        return self


class SiasunConfig(_Section, MotionLimits, ErrorList):
    """Motion and state channels of one robot, and the bounds of every target."""

    command_port: Port
    state_port: Port
    reply_timeout_s: Seconds = 1.0
    """Longest wait for the answer to a command, and then for the state to show its effect."""
    stop_timeout_s: Seconds = 3.0
    """Longest wait for the standstill after a stop; then the links are dropped, and the dead man
    stops the arm."""
    move_timeout_s: Seconds = 120.0
    """Longest move. One that takes longer is stopped: its end may have got lost."""
    stale_s: Seconds = 0.25
    """No motion starts on a state older than this."""
    silence_s: Seconds = 0.5
    """A robot without a state report for this long counts as lost."""

    @model_validator(mode="after")
    def _two_ports(self) -> Self:
        # Each channel has a listener of its own; the second one would find its port in use.
        if self.command_port == self.state_port:
            raise ValueError("command_port and state_port must differ")
        return self


class SiasunStopChannelConfig(_Section):
    """The guard's own channel to the same controller."""

    guard_port: Port


def _is_loopback(host: str) -> bool:
    return host == "localhost" or ip_address(host).is_loopback
