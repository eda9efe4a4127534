"""The detectors of one arming."""

from cellctl.guard.detectors import Burst, Cusum, Frozen, RateWindow
from cellctl.guard.limits import GuardLimits, Six


class Watch:
    """Made when the guard is armed, thrown away when it is disarmed."""

    def __init__(self, limits: GuardLimits, bad_frames: int, now_s: float) -> None:
        self.limits = limits
        self.frozen = Frozen(limits.frozen_samples)
        self.rate = RateWindow(limits.rate_hz, limits.rate_window_s, now_s)
        self.touch_axis = limits.touch.axis if limits.touch is not None else 0
        self._touch = Cusum(limits.touch) if limits.touch is not None else None
        self._bad_frames = Burst(limits.bad_frames, limits.bad_frames_window_s, bad_frames)

    def touched(self, wrench: Six) -> bool:
        """True when this sample completes a touch."""
        return self._touch is not None and self._touch.update(wrench[self.touch_axis])

    def bad_frames(self, total: int, now_s: float) -> bool:
        """True when too many frames were bad lately."""
        return self._bad_frames.update(total, now_s)
