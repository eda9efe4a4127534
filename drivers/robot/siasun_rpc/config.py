"""The settings of a SIASUN collaborative arm in the cell file. mm, degrees, mm/s, seconds."""

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from cellctl.geometry.euler_order import EulerOrder
from drivers.robot.siasun.config import MotionLimits, Port, Seconds
from drivers.robot.siasun.controller_errors import ErrorList

Word = Annotated[int, Field(ge=1, le=32)]
"""Number of a word register of the controller."""
FrameName = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,32}$", examples=["Tool_1"])]


class _Controller(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    host: str
    """Address of the controller."""
    rpc_port: Port = 7003
    tool: FrameName
    """Name of a tool on the controller whose frame is that of the flange. Every pose is asked for
    and sent with it, so that another choice at the pendant changes nothing."""
    work_frame: FrameName
    """Name of a work object on the controller whose frame is that of the robot base."""
    euler: EulerOrder
    """How this controller writes an orientation. To be verified on site; there is no default."""
    connect_timeout_s: Seconds = 5.0
    """Longest wait for all connections and a first state."""
    reply_timeout_s: Annotated[float, Field(gt=0.0, le=10.0)] = 0.5
    """Longest wait for a reply. Calls return at once, also those that begin a motion."""
    heartbeat_ms: Annotated[int, Field(ge=50, le=2000)] = 400
    """The controller stops the arm when it has had no heartbeat of a client for so long."""


class SiasunRpcConfig(_Controller, MotionLimits, ErrorList):
    """Connections to one controller, and the bounds of every target."""

    state_port: Port = 2001
    stop_word: Word | None = None
    """Word register that the guard's stop channel counts its stops in."""
    rearm_word: Word | None = None
    """Word register in which this driver acknowledges them."""
    poll_period_s: Annotated[float, Field(ge=0.005, le=0.1)] = 0.02
    """Pause between two questions for the state of the arm: as often as other robots report."""
    stop_timeout_s: Seconds = 3.0
    """Longest wait for the standstill after a stop; then the connections are dropped, and the
    missing heartbeat stops the arm."""
    move_timeout_s: Seconds = 120.0
    """Longest move. One that takes longer is stopped: its end may have got lost."""
    stale_s: Seconds = 0.25
    """No motion starts on a state older than this."""
    silence_s: Seconds = 0.5
    """A controller that answers nothing, or sends no state frame, for this long counts as lost."""
    joint_acceleration_percent: Annotated[int, Field(ge=1, le=100)] = 25
    """Acceleration of joint moves, as a share of the rated one."""
    servo_period_ms: Annotated[int, Field(ge=10, le=100)] | None = None
    """Period of streamed setpoints. None, as long as it was not measured on this arm and this PC:
    streamed motion is not offered then. Shorter ones are not proven (docs/protocols/siasun-rpc.md,
    section 9)."""
    servo_joint_speed_deg_s: Annotated[float, Field(gt=0.0, le=225.0)] = 20.0
    """Greatest speed of any joint in streamed motion, held by the controller."""
    servo_joint_acceleration_deg_s2: Annotated[float, Field(gt=0.0, le=2000.0)] = 200.0
    """Greatest acceleration of any joint in streamed motion, held by the controller: the speed
    above is reached in a tenth of a second."""
    servo_smooth_speed: Annotated[float, Field(ge=1.0, le=10.0)] = 1.0
    """Smoothing of the servo call; 1 is none. Smoothing would add to the dead time of a contact."""
    servo_smooth_acceleration: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    """The same for the acceleration; 0 is none."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if (self.stop_word is None) != (self.rearm_word is None):
            raise ValueError("stop_word and rearm_word are given both or not at all")
        if self.stop_word is not None and self.stop_word == self.rearm_word:
            raise ValueError("stop_word and rearm_word must differ: each has one writer")
        period_ms = self.servo_period_ms
        if period_ms is not None and self.max_stream_loss_s < 3.0 * period_ms / 1000.0:
            raise ValueError("max_stream_loss_s must be at least three times servo_period_ms")
        return self


class SiasunRpcStopChannelConfig(_Controller):
    """The guard's own connections to the same controller."""

    stop_word: Word
    rearm_word: Word

    @model_validator(mode="after")
    def _differ(self) -> Self:
        if self.stop_word == self.rearm_word:
            raise ValueError("stop_word and rearm_word must differ: each has one writer")
        return self
