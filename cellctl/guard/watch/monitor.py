"""The guard's judgement without any I/O: samples, flange poses and the time in, a trip out.

It fails closed: while armed, whatever is missing, too old, damaged or implausible is a trip. A
force that nobody can measure must be taken for one that is too great.

Time is an argument everywhere. The loop passes the monotonic clock, a test passes what it likes.
"""

from cellctl.errors.force import GuardRefused
from cellctl.guard.limits import DEFAULT_FILTER_S, GuardLimits, Six
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.guard.watch.contact_wrench import (
    ZERO,
    ContactWrenchModel,
    Nine,
    TareAverage,
    TareSums,
)
from cellctl.guard.watch.detectors import ArmedDetectors, LowPass, beyond
from cellctl.interfaces.ft_sensor import FtHealth, WrenchSample
from cellctl.interfaces.stop_channel import FlangeState

_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
_UNITS = ("N", "N", "N", "N·m", "N·m", "N·m")
_NEVER = float("-inf")
_FRESH_S = 0.05
"""A newest sample of this age is good enough to arm on. The request itself takes a few milliseconds
to come, so a staleness limit shorter than that would refuse every arming."""
_LONGEST_TARE_S = 60.0
"""Far above any tare in use, which takes half a second: a longer one is a mistake of the caller,
and nothing can be armed while it runs."""

MOST_EXCUSED_S = 0.05
"""Longest part of a silence for which a machine that stood still is an excuse.

Once the machine runs again, what a box or a robot outside of it has sent lies in the socket. A
silence that lasts on is the device's own.
"""


class WrenchMonitor:
    """Turns each sample into a contact wrench and compares it with the limits that are armed.

    ``has_channel`` says whether there is a stop channel. The flange pose comes over the same
    channel, so without one there is no pose that could be too old.
    """

    def __init__(self, flange_R_sensor: Nine, *, has_channel: bool) -> None:
        self.trip: GuardTrip | None = None
        """Latched until ``acknowledge``."""
        self.contact = ContactWrenchModel(flange_R_sensor)
        self.tare_result: TareSums | None = None
        """Set when a tare completes; the request handler takes it away with its answer."""
        self.peak_raw: list[float] = [0.0] * 6
        """Greatest magnitude of each component since the zero changed last."""
        self.peak_filtered: list[float] = [0.0] * 6
        self.sample_time_s = _NEVER
        """When the newest sample arrived."""
        self.flange_time_s = _NEVER
        """When the newest flange pose arrived."""
        self.channel_up = not has_channel
        self._has_channel = has_channel
        self._filter = LowPass(DEFAULT_FILTER_S)
        self._armed: ArmedDetectors | None = None
        self._tare: TareAverage | None = None
        # Two excuses and not one: a sample that arrives ends the silence of the sensor, but says
        # nothing about the robot.
        self._sample_excuse_s = self._flange_excuse_s = 0.0

    @property
    def armed(self) -> bool:
        """True while limits are watched."""
        return self._armed is not None

    # --- what arrives

    def sample(self, sample: WrenchSample) -> Six:
        """Judge one sample; returns its contact wrench in the wrench frame."""
        raw = sample[3:9]
        wrench = self.contact.apply(raw)
        filtered = self._filter.update(wrench, sample.time_s)
        self.sample_time_s, self._sample_excuse_s = sample.receive_time_s, 0.0
        # Before the judgement, so that the peak of the sample that trips is in the record of the
        # run.
        _raise_peaks(self.peak_raw, wrench)
        _raise_peaks(self.peak_filtered, filtered)
        if self._tare is not None:
            self._continue_tare(self._tare, wrench, sample.time_s)
        armed = self._armed
        if armed is not None and self.trip is None:
            self._judge(armed, sample, wrench, filtered)
        return wrench

    def flange(self, state: FlangeState) -> None:
        """Take a flange pose: it says where gravity points in the sensor."""
        self.flange_time_s, self._flange_excuse_s = state.time_s, 0.0
        self.contact.set_flange(state.rotation)

    def sensor_health(self, health: FtHealth, now_s: float) -> None:
        """Look at the driver's counters after each read: damaged frames are no samples."""
        armed = self._armed
        if armed is None or self.trip is not None:
            return
        bad = health.checksum_errors + health.invalid
        if armed.bad_frames(bad, now_s):
            detail = (
                f"{armed.limits.bad_frames} damaged frames within "
                f"{armed.limits.bad_frames_window_s * 1e3:.0f} ms ({health.checksum_errors} wrong "
                f"checks, {health.invalid} without new finite values since the start)"
            )
            self.stop(TripReason.SENSOR_INVALID, now_s, detail, value=float(bad))

    def tick(self, now_s: float) -> None:
        """Look for what shows only by the clock; call at least every few milliseconds.

        The ages are compared with ``not age <= limit``: an age that is NaN is too old as well.
        """
        armed = self._armed
        if armed is None or self.trip is not None:
            return
        armed.end_of_braking(now_s)
        limits = armed.limits
        silent_s = now_s - self.sample_time_s - self._sample_excuse_s
        if not silent_s <= limits.stale_s:
            detail = f"no sample for {silent_s * 1e3:.1f} ms, allowed {limits.stale_s * 1e3:.1f} ms"
            detail += _excused(self._sample_excuse_s)
            self.stop(TripReason.SENSOR_SILENT, now_s, detail, value=silent_s)
        elif armed.rate.check(now_s):
            detail = f"{armed.rate.rate_hz:.0f} Hz, allowed {limits.rate_hz[0]:.0f} … "
            detail += f"{limits.rate_hz[1]:.0f} Hz"
            self.stop(TripReason.SENSOR_RATE, now_s, detail, value=armed.rate.rate_hz)
        elif self._has_channel:
            self._check_flange(limits, now_s)

    def excuse(self, seconds: float) -> None:
        """Do not count this time as silence: the machine stood still and could not read.

        The next sample or pose ends the excuse, so it never hides more than the pause itself, nor
        more than ``MOST_EXCUSED_S``: nobody judges the force meanwhile, and the robot moves.
        """
        self._sample_excuse_s = min(self._sample_excuse_s + seconds, MOST_EXCUSED_S)
        self._flange_excuse_s = min(self._flange_excuse_s + seconds, MOST_EXCUSED_S)
        if self._armed is not None:
            self._armed.rate.excuse(seconds)

    def stop(
        self,
        reason: TripReason,
        now_s: float,
        detail: str,
        component: int | None = None,
        value: float = 0.0,
    ) -> None:
        """Latch a trip, unless one is latched already or the guard is not armed.

        The first one stays: it is the cause, what follows is often its consequence.
        """
        if self._armed is not None and self.trip is None:
            self.trip = GuardTrip(reason, now_s, detail, component, value)

    # --- what the daemon asks for; each raises ``GuardRefused`` with its reason

    def arm(self, limits: GuardLimits, health: FtHealth, now_s: float) -> None:
        """Watch these limits from the next sample on; they replace those watched before.

        Refused unless everything that the limits rely on is there: every move that follows relies
        on the armed guard.
        """
        if self.trip is not None:
            raise GuardRefused(f"a trip is latched: {self.trip}")
        if not self.contact.gravity_compensated:
            raise GuardRefused("no gravity compensation is set")
        if self._tare is not None:
            raise GuardRefused("a tare is running")
        age_s = now_s - self.sample_time_s
        if not age_s <= max(limits.stale_s, _FRESH_S):
            raise GuardRefused(f"the newest sample is {age_s:.3f} s old")
        if not self.channel_up:
            raise GuardRefused("the stop channel is down")
        pose_age_s = now_s - self.flange_time_s
        if self._has_channel and not pose_age_s <= limits.flange_age_s:
            raise GuardRefused(f"the flange pose is {pose_age_s:.3f} s old")
        # The same filter goes on where it can: a new one would start at a single noisy sample.
        if self._filter.time_constant_s != limits.filter_s:
            self._filter = LowPass(limits.filter_s)
        # Damaged frames that were counted before the arming belong to no motion and do not count
        # here.
        self._armed = ArmedDetectors(limits, health.checksum_errors + health.invalid, now_s)

    def disarm(self) -> None:
        """Watch nothing. A latched trip stays latched."""
        self._armed = None

    def brake(self, now_s: float) -> None:
        """The daemon has asked for a stop: what the load makes of braking is no contact."""
        if self._armed is not None:
            self._armed.brake(now_s)

    def acknowledge(self) -> None:
        """Release the latch; the guard is disarmed after it.

        The old limits belonged to the motion that was stopped. The next motion arms its own.
        """
        self.trip = None
        self._armed = None

    def begin_tare(self, duration_s: float, now_s: float) -> None:
        """Average over the samples of the next ``duration_s`` and subtract that from then on.

        Refused while armed: the limits would be compared with a zero that moves.
        """
        if self.armed:
            raise GuardRefused("no tare while armed")
        if self._tare is not None:
            raise GuardRefused("a tare is running")
        if not 0.0 < duration_s <= _LONGEST_TARE_S:
            raise GuardRefused(f"a tare of {duration_s} s")
        self._tare, self.tare_result = TareAverage(now_s, duration_s), None

    def cancel_tare(self) -> None:
        """Give up on a tare; the old zero stays."""
        self._tare = None

    def require_unarmed(self) -> None:
        """Refuse while armed: a new frame or load makes the signal jump, which would trip."""
        if self.armed:
            raise GuardRefused("not while armed")

    def signal_jumped(self) -> None:
        """Restart filter and peaks after the zero has changed."""
        self._filter.reset()
        self.peak_raw, self.peak_filtered = list(ZERO), list(ZERO)

    # --- inside

    def _judge(
        self, armed: ArmedDetectors, sample: WrenchSample, wrench: Six, filtered: Six
    ) -> None:
        """Trip on the first thing that is wrong with one sample.

        A reading that cannot be trusted comes before what it reads: a saturated channel may well
        be within all limits.
        """
        armed.rate.add()
        now_s, limits = sample.receive_time_s, armed.limits
        if sample.saturated:
            self.stop(TripReason.SENSOR_SATURATED, now_s, "a channel is at the end of its range")
        elif armed.frozen.update(sample[3:9]):
            detail = f"{armed.frozen.count} samples in a row are equal in all six channels"
            self.stop(TripReason.SENSOR_FROZEN, now_s, detail, value=float(armed.frozen.count))
        elif (index := beyond(wrench, limits.raw)) is not None:
            self._stop_at(TripReason.RAW_LIMIT, now_s, index, wrench[index], limits.raw[index])
        elif (index := beyond(filtered, limits.filtered)) is not None:
            value, limit = filtered[index], limits.filtered[index]
            self._stop_at(TripReason.FILTERED_LIMIT, now_s, index, value, limit)
        elif armed.touched(wrench):
            axis = armed.touch_axis
            detail = f"{_COMPONENTS[axis]} {wrench[axis]:.1f} {_UNITS[axis]}"
            self.stop(TripReason.TOUCH, now_s, detail, axis, wrench[axis])

    def _stop_at(
        self, reason: TripReason, now_s: float, index: int, value: float, limit: float
    ) -> None:
        unit = _UNITS[index]
        detail = f"{_COMPONENTS[index]} {value:.2f} {unit}, limit {limit:.2f} {unit}"
        self.stop(reason, now_s, detail, index, value)

    def _check_flange(self, limits: GuardLimits, now_s: float) -> None:
        age_s = now_s - self.flange_time_s - self._flange_excuse_s
        if not age_s <= limits.flange_age_s:
            allowed_ms = limits.flange_age_s * 1e3
            detail = f"newest pose {age_s * 1e3:.0f} ms old, allowed {allowed_ms:.0f} ms"
            detail += _excused(self._flange_excuse_s)
            self.stop(TripReason.FLANGE_STALE, now_s, detail, value=age_s)

    def _continue_tare(self, tare: TareAverage, wrench: Six, time_s: float) -> None:
        result = tare.add(self.contact.untared(wrench), time_s)
        if result is not None:
            self.contact.set_tare(result.mean)
            self.signal_jumped()
            self._tare, self.tare_result = None, result


def _excused(excused_s: float) -> str:
    """What a trip for silence says of the pauses of the machine that were not counted."""
    return f", besides {excused_s * 1e3:.0f} ms of a machine that stood still" if excused_s else ""


def _raise_peaks(peaks: list[float], wrench: Six) -> None:
    for index, value in enumerate(wrench):
        peaks[index] = max(peaks[index], abs(value))
