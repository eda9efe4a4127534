"""Whether both images of a pair show the same moment, by the clocks of PC and cameras."""

import math

from cellctl.errors.camera import CamerasNotTogether
from drivers.camera.gige.config import GigeHeadConfig
from drivers.camera.gige.protocol import SentImage

_CLOCK_DRIFT = 200e-6
"""Drift of two quartz clocks against each other; makers state 50 to 100 ppm for each."""


class Simultaneity:
    """Remembers the pair before: clocks that were set apart are compared by their change."""

    def __init__(self, name: str, config: GigeHeadConfig) -> None:
        self._name = name
        self._trigger = config.trigger
        self._max_difference_s = config.max_difference_s
        self._clocks_agree = config.clocks_agree
        self._ahead: tuple[float, float] | None = None
        """What the last pair said: monotonic time, and how far the clock of the left camera was
        before the right one's."""

    def forget(self) -> None:
        """Drop what the pair before has told: the clocks begin anew."""
        self._ahead = None

    def require(self, left: SentImage, right: SentImage) -> None:
        """Raise ``CamerasNotTogether`` for images that were exposed too far apart.

        What moved in between would be in one image only.
        """
        apart_s = self._apart_s(left, right)
        ahead = self._by_clocks(left, right)
        before, self._ahead = self._ahead, ahead
        if ahead is not None and self._clocks_agree:
            # Of cameras that run freely the clocks know better than this PC.
            freely = self._trigger == "none"
            apart_s = abs(ahead[1]) if freely else max(apart_s, abs(ahead[1]))
        elif ahead is not None and before is not None and self._trigger != "none":
            # Each camera has a clock of its own, and only the change of their difference says
            # something; clocks drift apart by themselves meanwhile.
            change_s = abs(ahead[1] - before[1])
            apart_s = max(apart_s, change_s - _CLOCK_DRIFT * (ahead[0] - before[0]))
        if apart_s > self._max_difference_s:
            self._ahead = None
            raise CamerasNotTogether(
                f"{self._name}: {apart_s * 1e3:.1f} ms apart, allowed "
                f"{self._max_difference_s * 1e3:.1f} ms"
            )

    @staticmethod
    def _by_clocks(left: SentImage, right: SentImage) -> tuple[float, float] | None:
        """None where an image has no time of its camera: 0 is none, and no time that agrees."""
        if not (left.device_time_ns and right.device_time_ns):
            return None
        return left.time_s, (left.device_time_ns - right.device_time_ns) * 1e-9

    def _apart_s(self, left: SentImage, right: SentImage) -> float:
        """What this PC knows of the time between both exposures."""
        if self._trigger == "none":
            # Both were exposed at some time between the request and the last image.
            return max(left.time_s, right.time_s) - min(left.trigger_s, right.trigger_s)
        by_wire = math.isnan(right.trigger_s)
        return 0.0 if by_wire else right.trigger_s - left.trigger_s
