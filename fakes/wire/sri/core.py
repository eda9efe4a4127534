"""The measuring core of the fake box, without I/O: samples in the unit that was asked for."""

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from fakes.wire.sri import transducer as sri_transducer
from fakes.wire.sri.faults import SriFaults
from fakes.wire.sri.frames import build_frame, pack_counts, pack_floats
from fakes.wire.sri.settings import DataFormat, SriSettings
from fakes.wire.sri.transducer import Transducer, Vector

_FALSE_HEADER = b"\xaa\x55\x00\x1b"
"""The beginning of a frame with the length of six floats, a number and a sum (27 bytes)."""
_LONGEST_FILTER = 16
"""Weights of the mean that SGDM takes at most."""


class SriCore:
    """One box: transducer, parameters, faults and the package counter, shared by all its links."""

    def __init__(
        self,
        sample: Callable[[float], Sequence[float]],
        settings: SriSettings | None = None,
        faults: SriFaults | None = None,
    ) -> None:
        self.settings = settings or SriSettings()
        self.faults = faults or SriFaults()
        self.transducer = Transducer(sample)
        self.next_number = 0
        self._held: Vector | None = None
        self._points = 0
        self._history: deque[Vector] = deque(maxlen=_LONGEST_FILTER)

    def frame(self, times_s: Sequence[float], data_format: DataFormat | None = None) -> bytes:
        """The next frame with one point for each time. Advances the package number."""
        chosen = data_format or self.settings.data_format
        points = [self.point(time_s, chosen) for time_s in times_s]
        data = pack_counts(points) if chosen.unit == "C" else pack_floats(points)
        data = self._spoil(data, chosen)
        number = self.next_number
        if not self.faults.uncounted:
            self.next_number = (number + 1) & 0xFFFF
        return build_frame(number, data, self.settings.check)

    def point(self, time_s: float, data_format: DataFormat) -> Vector:
        """One point in the format's unit and channels, after its filter."""
        signal = self._filtered(self._signal(time_s), data_format.weights)
        if data_format.unit == "E":
            values = sri_transducer.engineering(
                signal, self.settings.matrix, self.settings.raw_unit
            )
        elif data_format.unit == "M":
            values = signal
        else:
            values = sri_transducer.counts(signal)
        return values[list(data_format.channels)]

    def adjust_zero(self, flags: str, time_s: float) -> str:
        """Carry out ADJZF with ``f1;…;f6`` and return the flags."""
        channels = flags.split(";")
        if len(channels) != 6 or not set(channels) <= {"0", "1"}:
            raise ValueError(flags)
        self.transducer.adjust_zero([flag == "1" for flag in channels], time_s)
        return flags

    def _signal(self, time_s: float) -> Vector:
        if self.faults.saturated:
            return self.transducer.end_of_scale_mv_v
        if self.faults.frozen and self._held is not None:
            return self._held
        self._held = self.transducer.bridge_mv_v(time_s)
        self._points += 1
        if self.faults.jump_every and self._points % self.faults.jump_every == 0:
            return self._held + 0.5 * self.transducer.end_of_scale_mv_v
        return self._held

    def _filtered(self, signal: Vector, weights: tuple[float, ...]) -> Vector:
        self._history.append(signal)
        if len(weights) == 1:
            return signal
        newest = list(self._history)[-len(weights) :]
        used = weights[-len(newest) :]
        return signal if sum(used) == 0.0 else np.average(newest, axis=0, weights=used)

    def _spoil(self, data: bytes, data_format: DataFormat) -> bytes:
        if self.faults.nan:
            return b"\xff" * len(data)
        if not self.faults.header_in_data or data_format.unit == "C":
            return data
        spoilt = bytearray(data)
        for start in range(0, len(data), 4):
            spoilt[start : start + 2] = _FALSE_HEADER[:2]
        if len(data_format.channels) == 6:
            for start in range(12, len(data), 24):
                spoilt[start : start + 4] = _FALSE_HEADER
        return bytes(spoilt)
