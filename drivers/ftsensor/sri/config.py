"""The settings of an SRI interface box in the cell file. N, N·m, hertz, seconds."""

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drivers.ftsensor.sri.protocol import Check, FrameLayout, Unit

Finite = Annotated[float, Field(allow_inf_nan=False)]
Six = tuple[Finite, Finite, Finite, Finite, Finite, Finite]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
PositiveSix = tuple[Positive, Positive, Positive, Positive, Positive, Positive]
Matrix = tuple[Six, Six, Six, Six, Six, Six]
CanId = Annotated[int, Field(ge=0, le=0x7FF)]

_BITS_PER_BYTE = 10
"""On the serial line: a start bit, eight data bits, a stop bit."""


_CONVERTED = {
    "C": (
        "converter counts: newtons are made of them by gain, zero, excitation and matrix as the "
        "box states them"
    ),
    "M": (
        "bridge signals: newtons are made of them by the matrix that the box states, and that they "
        "are the input of this matrix no device has proven yet"
    ),
}
_WEIGH = (
    'the limits of guard and recipes are newtons, which "E" has from the box itself; right if a '
    "known weight, hung on the sensor, reads as what it weighs"
)


class SriConfig(BaseModel):
    """One sensor with its box."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    transport: Literal["tcp", "serial", "can"]
    serial_number: str = ""
    """Serial number on the sensor's type plate; the box cannot be asked for it."""

    host: str = "192.168.0.108"
    port: Annotated[int, Field(ge=1, le=65535)] = 4008

    device: str = ""
    """Serial device, for example /dev/ttyUSB0."""
    baud: Annotated[int, Field(ge=9600, le=4_000_000)] = 115_200

    can_interface: str = "socketcan"
    """Any interface of python-can."""
    can_channel: str = ""
    can_options: dict[str, Any] = {}
    """Further arguments of that interface, for example bitrate."""
    can_command_id: CanId = 0x80
    can_data_ids: tuple[CanId, CanId, CanId] = (0x291, 0x292, 0x293)
    """CAN ids of the three messages of a sample: Fx Fy, Fz Mx, My Mz."""

    rate_hz: Annotated[float, Field(ge=1.0, le=4000.0)] = 1000.0
    rate_tolerance: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    """Relative deviation of the measured rate beyond which a window is counted."""
    unit: Unit = "E"
    """What the box sends: E newtons, C converter counts, M bridge signals. The driver makes newtons
    and newton metres of C and M by the box's own matrix (of C also by its gain, zero and
    excitation), so that every limit is in newtons whatever stands here."""
    points: Annotated[int, Field(ge=1, le=80)] = 1
    """Samples in a frame of the stream."""
    filter_weights: Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(max_length=16)] = (1,)
    """Weighted moving mean inside the box, the newest sample last; (1,) is none."""
    check: Check = "SUM"
    crc: Literal["zlib", "mpeg2"] = "zlib"
    """The variant of CRC32; no public source has proven either on a device."""

    raw_unit: Literal["MVPV", "MV"] = "MVPV"
    """Expected unit of the box's matrix input. A wrong one looks plausible and is wrong by five."""
    matrix: Matrix | None = None
    """Decoupling matrix of the calibration sheet: the box's must be equal."""
    range: PositiveSix | None = None
    """Rated range of the sensor, Fx … Mz: a sample beyond it counts as saturated."""
    inverted: bool = False
    """True when mounted so that it reads the reaction: all six signs are turned."""

    connect_timeout_s: Positive = 3.0
    reply_timeout_s: Positive = 1.2
    """Longest wait for the reply to a command; public drivers of the box wait as long."""
    first_frame_timeout_s: Positive = 1.0
    """Longest wait for the first frame of a stream, and for the next one of a running stream."""
    reconnect_s: Positive = 0.5
    """Pause between attempts to connect again."""
    max_lag_s: Positive = 0.3
    """Samples that arrive later than this after they were taken end the connection. Seen where a
    stream starts late, or goes on late after a pause; a sample carries no time of its own."""

    @property
    def remarks(self) -> dict[str, str]:
        """What is possible and should be looked at again, by its key."""
        return {"unit": f"{_CONVERTED[self.unit]}; {_WEIGH}"} if self.unit in _CONVERTED else {}

    @property
    def layout(self) -> FrameLayout:
        """The frames that this configuration asks for."""
        return FrameLayout(self.unit, self.points, self.check, self.crc)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.transport == "serial":
            if not self.device:
                raise ValueError("transport serial needs `device`")
            frames_hz = self.baud / _BITS_PER_BYTE / self.layout.total_bytes
            # A line that is too slow does not fail: the box falls behind, and its samples come
            # later and later.
            if self.rate_hz / self.points > frames_hz:
                most = int(frames_hz * self.points)
                raise ValueError(f"{self.baud} baud carries at most {most} Hz in this format")
        if self.transport == "can":
            if not self.can_channel:
                raise ValueError("transport can needs `can_channel`")
            # The messages have a fixed layout of two floats each; nothing on CAN can ask for
            # another one.
            if (self.unit, self.points) != ("E", 1):
                raise ValueError("on CAN the box sends unit E, one point a frame")
        if sum(self.filter_weights) <= 0:
            raise ValueError("filter_weights need a positive sum")
        return self
