"""Parameters of the fake box and the AT commands that read and write them."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fakes.wire.sri.frames import CHECKS
from fakes.wire.sri.transducer import EXCITATION_V, FACTORY_MATRIX, GAIN, ZERO_COUNTS

_FORMAT = re.compile(
    r"\((?P<channels>A0[1-6](?:,A0[1-6]){0,5})\);(?P<unit>[ECM]);(?P<points>\d{1,3})"
    r"(?:;\(WMA:(?P<weights>[0-9.]+(?:,[0-9.]+){0,15})\))?"
)
_RATE_LIMIT_HZ = 2000.0
"""Highest rate that users are known to have set; the maker states no limit."""


@dataclass(frozen=True, slots=True)
class DataFormat:
    """The upload format of SGDM: which channels, unit, points per frame, weighted-mean filter."""

    channels: tuple[int, ...] = (0, 1, 2, 3, 4, 5)
    unit: str = "E"
    points: int = 1
    weights: tuple[float, ...] = (1.0,)

    @classmethod
    def parse(cls, text: str) -> "DataFormat":
        """Read ``(A01,…);E;1;(WMA:1)``; the filter part may be missing."""
        match = _FORMAT.fullmatch(text)
        if match is None or not 1 <= int(match["points"]) <= 80:
            raise ValueError(text)
        weights = tuple(float(w) for w in (match["weights"] or "1").split(","))
        if sum(weights) <= 0.0:
            raise ValueError(text)
        channels = tuple(int(name[1:]) - 1 for name in match["channels"].split(","))
        return cls(channels, match["unit"], int(match["points"]), weights)

    def __str__(self) -> str:
        names = ",".join(f"A{channel + 1:02d}" for channel in self.channels)
        weights = ",".join(f"{weight:.6f}" for weight in self.weights)
        return f"({names});{self.unit};{self.points};(WMA:{weights})"


@dataclass(slots=True, eq=False)
class SriSettings:
    """What the box keeps over a power cycle."""

    rate_hz: float = 200.0
    check: str = "SUM"
    data_format: DataFormat = DataFormat()
    matrix: NDArray[np.float64] = field(default_factory=lambda: FACTORY_MATRIX)
    raw_unit: str = "MVPV"
    ip_address: str = "192.168.0.108"
    port: str = "4008"
    uart: str = "115200,8,1.00,N"
    firmware: str = "M8128B1-FAKE-1.0"

    def query(self, name: str) -> str:
        """Value text of ``AT+<name>=?``; ``ValueError`` when there is no such parameter."""
        if name not in _QUERIES:
            raise ValueError(name)
        return _QUERIES[name](self)

    def write(self, name: str, text: str) -> str:
        """Carry out ``AT+<name>=<text>`` and return the value now in force."""
        if name not in _WRITERS:
            raise ValueError(name)
        _WRITERS[name](self, text)
        return self.query(name)


def _six(values: NDArray[np.float64]) -> str:
    return ";".join(f"{value:.6f}" for value in values)


def _matrix_text(settings: SriSettings) -> str:
    return ";".join("(" + ",".join(f"{v:.6f}" for v in row) + ")" for row in settings.matrix)


def _set_rate(settings: SriSettings, text: str) -> None:
    rate_hz = float(text)
    if not 1.0 <= rate_hz <= _RATE_LIMIT_HZ:
        raise ValueError(text)
    settings.rate_hz = rate_hz


def _set_check(settings: SriSettings, text: str) -> None:
    if text not in CHECKS:
        raise ValueError(text)
    settings.check = text


def _set_raw_unit(settings: SriSettings, text: str) -> None:
    if text not in ("MVPV", "MV"):
        raise ValueError(text)
    settings.raw_unit = text


def _set_matrix(settings: SriSettings, text: str) -> None:
    if not re.fullmatch(r"\([^()]+\)(;\([^()]+\)){5}", text):
        raise ValueError(text)
    rows = [[float(v) for v in row.split(",")] for row in text.strip("()").split(");(")]
    if any(len(row) != 6 for row in rows) or not np.isfinite(rows).all():
        raise ValueError(text)
    settings.matrix = np.array(rows)


def _set_data_format(settings: SriSettings, text: str) -> None:
    settings.data_format = DataFormat.parse(text)


def _set_points(settings: SriSettings, text: str) -> None:
    names, unit, _, weights = str(settings.data_format).split(";")
    settings.data_format = DataFormat.parse(f"{names};{unit};{text};{weights}")


def _set_text(attribute: str, pattern: str) -> Callable[[SriSettings, str], None]:
    def write(settings: SriSettings, text: str) -> None:
        if not re.fullmatch(pattern, text):
            raise ValueError(text)
        setattr(settings, attribute, text)

    return write


_QUERIES: dict[str, Callable[[SriSettings], str]] = {
    "SMPF": lambda s: f"{s.rate_hz:g}",
    "SMPR": lambda s: f"{s.rate_hz:g}",
    "DCKMD": lambda s: s.check,
    "SGDM": lambda s: str(s.data_format),
    "DNpCH": lambda s: str(s.data_format.points),
    "DCPM": _matrix_text,
    "DCPCU": lambda s: s.raw_unit,
    "EIP": lambda s: s.ip_address,
    "ETPT": lambda s: s.port,
    "UARTCFG": lambda s: s.uart,
    "SFWV": lambda s: s.firmware,
    "AMPZ": lambda _: _six(ZERO_COUNTS),
    "CHNAPG": lambda _: _six(GAIN),
    "EXMV": lambda _: _six(EXCITATION_V),
}

_WRITERS: dict[str, Callable[[SriSettings, str], None]] = {
    "SMPF": _set_rate,
    "SMPR": _set_rate,
    "DCKMD": _set_check,
    "SGDM": _set_data_format,
    "DNpCH": _set_points,
    "DCPM": _set_matrix,
    "DCPCU": _set_raw_unit,
    "EIP": _set_text("ip_address", r"\d{1,3}(\.\d{1,3}){3}"),
    "ETPT": _set_text("port", r"\d{1,5}"),
    "UARTCFG": _set_text("uart", r"\d+,[78],\d\.\d\d,[NOE]"),
}
