"""From checked frames to samples: times, gaps, values, and what is wrong with them."""

from cellctl.interfaces.ft_sensor import WrenchSample
from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.protocol import Frame, Six
from drivers.ftsensor.sri.timing import SampleClock
from drivers.ftsensor.sri.values import Conversion, engineering

_NUMBERS = 0x10000
"""The package number has 16 bits."""
_UNCOUNTED = 50
"""Frames of one number at the beginning of a stream: no box repeats its first frame so often."""
_RENUMBERED = _NUMBERS // 2
"""A step this large forward is a step back: the box has begun to count anew."""


class Sampler:
    """Lives as long as the driver; ``restart`` at each new stream."""

    def __init__(self, config: SriConfig) -> None:
        self.samples = 0
        self.lost = 0
        self.invalid = 0
        self.saturated = 0
        self.clock = SampleClock(config.rate_hz, config.rate_tolerance)
        self._points = config.points
        self._range = config.range
        self._sign = -1.0 if config.inverted else 1.0
        self._convert: Conversion = engineering
        self._last: int | None = None
        self._repeats_of_first: int | None = 0
        """Frames with the number of the first one; None from the first other number on."""

    @property
    def uncounted(self) -> int | None:
        """The number that all frames of this stream have, once there are too many for a chance."""
        repeats = self._repeats_of_first
        return self._last if repeats is not None and repeats >= _UNCOUNTED else None

    def restart(self, convert: Conversion) -> None:
        """The next frame begins a stream; its number is the origin."""
        self._convert = convert
        self._last = None
        self._repeats_of_first = 0
        self.clock.restart()

    def take(self, frames: list[Frame], receive_s: float) -> list[WrenchSample]:
        """Samples of frames that arrived together, oldest first."""
        found: list[WrenchSample] = []
        # Frames that arrive in one read were taken one period after the other, so only the last
        # sample can be as new as the read; ``behind`` counts how many came after each.
        behind = len(frames) * self._points
        for frame in frames:
            if frame.number == self._last:
                # The box has sent its last frame again. Taken for a new sample, an old force would
                # pass for the present one.
                self.invalid += 1
                behind -= self._points
                if self._repeats_of_first is not None:
                    self._repeats_of_first += 1
                continue
            if self._last is not None:
                self._repeats_of_first = None
            gap = self._gap(frame.number)
            self.lost += gap * self._points
            periods = gap * self._points + 1
            for point in frame.points:
                behind -= 1
                time_s = self.clock.stamp(receive_s, periods, behind)
                periods = 1
                sample = self._sample(receive_s, time_s, frame.number, point)
                if sample is not None:
                    found.append(sample)
        self.samples += len(found)
        return found

    def _gap(self, number: int) -> int:
        """Frames missing before this one."""
        last, self._last = self._last, number
        if last is None:
            return 0
        # The number has 16 bits and wraps about once a minute at 1 kHz.
        gap = (number - last - 1) % _NUMBERS
        if gap >= _RENUMBERED:
            self.clock.restart()
            return 0
        return gap

    def _sample(
        self, receive_s: float, time_s: float, number: int, point: tuple[float, ...]
    ) -> WrenchSample | None:
        # Spelled out in six plain variables: this runs for every sample in the guard process, where
        # arrays cost many times as much (decision 0003).
        (a, b, c, d, e, f), at_end = self._convert(point)
        total = a + b + c + d + e + f
        # One test for all six: NaN and infinities survive the sum, and do not cancel against
        # themselves.
        if total - total != 0.0:
            # Dropped and counted, never passed on: comparisons with NaN are false, so no limit
            # would notice it.
            self.invalid += 1
            return None
        sign = self._sign
        saturated = at_end or self._beyond((a, b, c, d, e, f))
        self.saturated += saturated
        return WrenchSample(
            receive_s,
            time_s,
            number,
            sign * a,
            sign * b,
            sign * c,
            sign * d,
            sign * e,
            sign * f,
            saturated,
        )

    def _beyond(self, values: Six) -> bool:
        if self._range is None:
            return False
        return any(abs(value) > most for value, most in zip(values, self._range, strict=True))
