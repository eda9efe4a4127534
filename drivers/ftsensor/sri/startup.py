"""The order in which a box is stopped, examined, set and started; no I/O.

Both start-ups are generators: they yield what to say and get back what was answered, so the same
code serves the first connection, which may wait, and a reconnection, which must not.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TypeVar

from drivers.ftsensor.sri import faults, values
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.protocol import (
    DataFormat,
    Reply,
    command,
    parse_format,
    parse_matrix,
    parse_six,
    parse_six_positive,
)

_DRAIN_S = 2.0
"""Longest wait for the reply to a stop, behind the frames that are still on their way. Public
drivers wait as long."""
_QUIET_S = 0.3
"""A box that has sent nothing at all for this time has stopped."""
_CHANNELS = ("A01", "A02", "A03", "A04", "A05", "A06")
_ONES = (1.0,) * 6
_MATRIX_TOLERANCE = 1e-4
"""Largest difference of an element from the calibration sheet, as a share of the greatest one in
its row."""


@dataclass(frozen=True, slots=True)
class Exchange:
    """One thing to send, and when to stop waiting for its answer."""

    send: bytes
    name: str
    timeout_s: float
    quiet_s: float | None = None
    """End early when nothing at all has arrived for so long."""


@dataclass(frozen=True, slots=True)
class BoxSetup:
    """What the start-up has found out."""

    firmware: str
    convert: values.Conversion


_T = TypeVar("_T")
StartUp = Generator[Exchange, Reply | None, BoxSetup]
_Ask = Generator[Exchange, Reply | None, str | None]


class AtCommandStartUp:
    """Start-up over TCP and serial, by AT commands. The last yield starts the stream."""

    def __init__(self, config: SriConfig) -> None:
        self._config = config

    def run(self) -> StartUp:
        """The exchanges from the first stop to the start of the stream.

        A previous session may still stream, so the box is stopped and drained before anything else.
        """
        # The answer comes behind the frames that are still on their way. Quiet counts as an answer
        # too: a box that sends nothing has stopped.
        yield Exchange(command("GSD", "STOP"), "GSD", _DRAIN_S, _QUIET_S)
        firmware = yield from self._ask("SFWV", "?")
        # Asked, not set: unit and matrix belong to the calibration of this sensor. To overwrite
        # them with what the cell file says would hide that the wrong box is connected.
        raw_unit = yield from self._need("DCPCU", "?")
        if raw_unit != self._config.raw_unit:
            raise faults.wrong_setup("unit of the matrix (DCPCU)", raw_unit, self._config.raw_unit)
        matrix = yield from self._matrix()
        yield from self._set_check()
        yield from self._set_format()
        yield from self._set_rate()
        convert = yield from self._conversion(matrix)
        # The start is not acknowledged: the first good frame is the answer.
        yield Exchange(command("GSD"), "", 0.0)
        return BoxSetup(firmware or "unknown firmware", convert)

    def _matrix(self) -> Generator[Exchange, Reply | None, values.Matrix]:
        text = yield from self._need("DCPM", "?")
        matrix = _parsed("matrix (DCPM)", parse_matrix, text)
        expected = self._config.matrix
        for row, want in zip(matrix, expected or matrix, strict=True):
            scale = max(map(abs, want)) or 1.0
            # Relative to the row: the box prints a limited number of decimals, and forces and
            # moments differ in size by orders of magnitude.
            if any(abs(a - b) > _MATRIX_TOLERANCE * scale for a, b in zip(row, want, strict=True)):
                raise faults.wrong_setup("a row of the matrix (DCPM)", row, want)
        return matrix

    def _set_check(self) -> Generator[Exchange, Reply | None, None]:
        """Firmware without DCKMD only knows SUM."""
        kind = yield from self._ask("DCKMD", self._config.check)
        if kind is None and self._config.check == "SUM":
            return
        if kind != self._config.check:
            raise faults.wrong_setup("frame check (DCKMD)", kind, self._config.check)

    def _set_format(self) -> Generator[Exchange, Reply | None, None]:
        config = self._config
        weights = tuple(float(weight) for weight in config.filter_weights)
        want = DataFormat(_CHANNELS, config.unit, config.points, weights)
        yield from self._need("SGDM", str(want))
        # Read back: an echo does not prove which format is in force.
        text = yield from self._need("SGDM", "?")
        if _parsed("data format (SGDM)", parse_format, text) != want:
            raise faults.wrong_setup("data format (SGDM)", text, want)

    def _set_rate(self) -> Generator[Exchange, Reply | None, None]:
        """SMPF, or SMPR on older firmware."""
        value = f"{self._config.rate_hz:g}"
        echo = yield from self._ask("SMPF", value)
        if echo is None:
            # Older firmware knows the rate by this name, and does not know the newer one.
            echo = yield from self._need("SMPR", value)
        if _parsed("rate (SMPF)", float, echo) != self._config.rate_hz:
            raise faults.wrong_setup("rate (SMPF)", echo, value)

    def _conversion(
        self, matrix: values.Matrix
    ) -> Generator[Exchange, Reply | None, values.Conversion]:
        if self._config.unit == "E":
            return values.engineering
        if self._config.unit == "M":
            return values.from_bridge(matrix)
        zero = _parsed("zero (AMPZ)", parse_six, (yield from self._need("AMPZ", "?")))
        gain = _parsed("gain (CHNAPG)", parse_six_positive, (yield from self._need("CHNAPG", "?")))
        excitation_v: tuple[float, ...] = _ONES
        if self._config.raw_unit == "MVPV":
            text = yield from self._need("EXMV", "?")
            excitation_v = _parsed("excitation (EXMV)", parse_six_positive, text)
        return values.from_counts(matrix, zero, gain, excitation_v)

    def _ask(self, name: str, value: str) -> _Ask:
        """The value of the reply; None when the box refuses or stays silent."""
        reply = yield Exchange(command(name, value), name, self._config.reply_timeout_s)
        return reply.value if reply is not None and reply.ok else None

    def _need(self, name: str, value: str) -> Generator[Exchange, Reply | None, str]:
        reply = yield Exchange(command(name, value), name, self._config.reply_timeout_s)
        if reply is None:
            raise faults.no_reply(self._peer, f"{name}={value}")
        if not reply.ok:
            raise faults.wrong_setup(f"answer to {name}={value}", "an error", "its value")
        return reply.value

    @property
    def _peer(self) -> str:
        config = self._config
        return config.device if config.transport == "serial" else f"{config.host}:{config.port}"


class CanStartUp:
    """Start-up over CAN, which has no questions: stop, drain, start."""

    START, STOP = b"\x02", b"\x00"

    def run(self) -> StartUp:
        """Stop what a previous session left running, then start."""
        yield Exchange(self.STOP, "", _DRAIN_S, _QUIET_S)
        yield Exchange(self.START, "", 0.0)
        return BoxSetup("firmware not readable over CAN", values.engineering)


def _parsed(what: str, parse: Callable[[str], _T], text: str) -> _T:
    try:
        return parse(text)
    except ValueError as error:
        raise faults.wrong_setup(what, repr(text), "a readable value") from error
