"""Dead time and stiffness of a contact loop from what it did, and whether they explain it.

Source: section 4.5 of the study of insertion by touch, which also has the limits below. The arm is
swung by a chirp in free air and on the face; ``fit_delay`` finds how late it follows. At standstill
``fit_stiffness`` compares force and travel. Then the loop is closed with the gains that follow, and
``fit_loop`` and ``check_step`` ask whether it behaves as they say.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, minimize_scalar
from scipy.signal import lfilter

from cellctl.errors.streamed_contact import LoopFitRefused
from cellctl.force.contact.streamed.gains import LoopFigures
from cellctl.geometry.pose import Array

BURST_TICKS = 200
"""Least ticks of a burst. A dead time that holds for some bursts of a chirp only would be lost in a
fit over the whole; the loop is planned with the greatest."""
BURST_S = 0.5
"""Least length of a burst where ticks are short: a fit needs some swing of the chirp, however many
ticks."""
_FADED_SHARE = 0.1
"""Share of a chirp at either end over which it is faded in and out."""
TICKS_OF_THE_LOOP = 1.5
"""Ticks that a sampled loop adds to the delay from command to force: one for reading and computing,
and half of one because a setpoint is held until the next."""
_SLOWEST_CHIRP_HZ, FASTEST_CHIRP_HZ = 0.5, 8.0
"""Frequencies between which a chirp rises."""
_STEPS_IN_A_TICK = 4
"""Points of the model's grid in a tick: a delay is rarely a whole number of ticks."""
_GREATEST_RESIDUAL = 0.25
"""Greatest residual of a fit over the standard deviation of the response. Beyond that the response
is not mainly a delayed command, and a delay that was fitted to it means nothing."""
_TOLERANCE = 0.30
"""Greatest relative difference of k θ between the closed loop and the calculation."""
_GREATEST_OVERSHOOT = 0.15
"""Greatest overshoot of a step in the closed loop. The gains are made for 6 to 8 %."""
_SETTLED_SHARE = 0.1
"""A force within this share of the step has settled."""
_SETTLED_DEAD_TIMES = 6.0
"""Within this many dead times a step has to settle. The gains are made for 3.5."""


@dataclass(frozen=True, slots=True)
class DelayFit:
    """A response that follows its command later and, as through a low-pass, slower."""

    delay_s: float
    lag_s: float
    gain: float
    residual: float
    """Root mean square, in the unit of the response."""

    @property
    def dead_time_s(self) -> float:
        """Delay and lag together: a signal that is slow against the lag comes late by their sum."""
        return self.delay_s + self.lag_s


@dataclass(frozen=True, slots=True)
class StiffnessFit:
    """Travel against force at standstill."""

    stiffness_n_m: float
    sigma_n_m: float
    hysteresis_m: float
    """Greatest difference of a reading from the straight line."""


def chirp(amplitude_m: float, duration_s: float, period_s: float) -> Array:
    """Displacement (m) at every tick, shape (n,): a sine whose frequency rises from 0.5 to 8 Hz.

    It begins and ends at rest at nought.
    """
    time_s = np.arange(round(duration_s / period_s) + 1) * period_s
    rate = (FASTEST_CHIRP_HZ - _SLOWEST_CHIRP_HZ) / duration_s
    phase = 2 * np.pi * (_SLOWEST_CHIRP_HZ * time_s + rate * time_s**2 / 2)
    # A chirp that began or ended with a jump would make the arm swing at its own frequency, which
    # says nothing about its delay.
    from_the_ends_s = np.minimum(time_s, time_s[-1] - time_s)
    fade = np.clip(from_the_ends_s / (_FADED_SHARE * duration_s), 0.0, 1.0)
    return np.asarray(amplitude_m * fade * np.sin(phase))


def fit_delay(sent_s: Array, command: Array, read_s: Array, response: Array) -> DelayFit:
    """Delay and lag from commands, each held until the next, to responses.

    Shapes (n,) of the commands and (m,) of the responses, in time order; the times of both may be
    irregular. Raises ``LoopFitRefused`` when a delay does not explain the response.
    """
    period_s = float(np.median(np.diff(sent_s)))
    grid_s = np.arange(sent_s[0], read_s[-1] + period_s, period_s / _STEPS_IN_A_TICK)

    # The solver stops when the errors change by little in numbers. In metres they would always be
    # small, so they are divided by the size of the response.
    scale = max(float(np.std(response)), 1e-12)

    def model(parameters: Array) -> tuple[Array, Array]:
        delay_s, lag_s = parameters
        late = _held_mean(grid_s - delay_s, sent_s, command, period_s)
        # A first-order lag by the trapezoidal rule, which stays stable for any ratio of lag and
        # grid. The filter starts at rest at the first value.
        share = 2.0 * max(lag_s, 1e-6) * _STEPS_IN_A_TICK / period_s
        numerator, denominator = [1.0, 1.0], [share + 1.0, 1.0 - share]
        begun = lfilter(numerator, denominator, late - late[0]) + late[0]
        shaped = np.interp(read_s, grid_s, begun)
        # Gain and offset of the response are linear: solved here for each delay and lag, they need
        # no starting values and cannot lead the search astray.
        design = np.stack([shaped, np.ones_like(shaped)], axis=1)
        solved = np.linalg.lstsq(design, response, rcond=None)[0]
        return np.asarray(design @ solved - response), np.asarray(solved)

    begin = np.array([2.0 * period_s, period_s])

    def scaled(parameters: Array) -> Array:
        return model(parameters)[0] / scale

    fit = least_squares(
        scaled,
        begin,
        # No loop with a dead time of 0.2 s could press on anything (``check_press``).
        bounds=([0.0, 1e-5], [0.2, 0.2]),
        x_scale=period_s,
        diff_step=np.array([1e-3, 1e-3]),
    )
    errors, solved = model(fit.x)
    residual = float(np.sqrt(np.mean(errors**2)))
    if residual > _GREATEST_RESIDUAL * float(np.std(response)):
        raise LoopFitRefused(
            f"the response is {residual:.3g} off a delayed command, of a variation of "
            f"{float(np.std(response)):.3g}"
        )
    return DelayFit(float(fit.x[0]), float(fit.x[1]), float(solved[0]), residual)


def _held_mean(at_s: Array, sent_s: Array, values: Array, window_s: float) -> Array:
    """Means over a window round each time of a signal that is held from value to value.

    Over one tick, so that a fit sees no steps; it shifts nothing. A gap of two ticks is a value
    that is held for two.
    """
    ends_s = np.append(sent_s, max(at_s[-1], sent_s[-1]) + window_s)
    held = np.concatenate([[0.0], np.cumsum(values * np.diff(ends_s))])
    before_s = np.minimum(at_s - window_s / 2 - sent_s[0], 0.0)
    begun_s = np.minimum(at_s + window_s / 2 - sent_s[0], 0.0)
    later = np.interp(at_s + window_s / 2, ends_s, held) + begun_s * values[0]
    sooner = np.interp(at_s - window_s / 2, ends_s, held) + before_s * values[0]
    return np.asarray((later - sooner) / window_s)


def burst_dead_times(
    sent_s: Array,
    command: Array,
    read_s: Array,
    response: Array,
    *,
    in_use_s: Array | None = None,
) -> Array:
    """Dead times (s) of the bursts of a chirp, 200 ticks or more each; shape (bursts,).

    Commands have shape (n,), responses shape (n,) too, one for each tick. ``in_use_s`` of shape
    (n,) is how old the newest response is when a loop sends its next command; its mean over the
    burst is added, since the loop acts on a force of that age.
    """
    faded = round(_FADED_SHARE * len(command))
    whole = np.arange(faded, len(command) - faded)
    least = max(BURST_TICKS, round(BURST_S / float(np.median(np.diff(sent_s)))))
    pieces = np.array_split(whole, max(1, len(whole) // least))
    fits = [fit_delay(sent_s[p], command[p], read_s[p], response[p]) for p in pieces]
    ages_s = [0.0 if in_use_s is None else float(in_use_s[p].mean()) for p in pieces]
    return np.array([fit.dead_time_s + age_s for fit, age_s in zip(fits, ages_s, strict=True)])


def fit_stiffness(travel_m: Array, force_n: Array) -> StiffnessFit:
    """Stiffness from n ≥ 4 readings at standstill, at forces that differ.

    Raises ``LoopFitRefused`` when travel does not grow with force.
    """
    if len(force_n) < 4 or float(np.ptp(force_n)) <= 0:
        raise LoopFitRefused(f"{len(force_n)} readings of force and travel, four are needed")
    # Travel on force and not the other way round: on a stiff contact the travel is the noisy one.
    design = np.stack([force_n, np.ones_like(force_n)], axis=1)
    solved = np.linalg.lstsq(design, travel_m, rcond=None)[0]
    errors = design @ solved - travel_m
    variance = float(errors @ errors) / (len(force_n) - 2)
    sigma = np.sqrt(variance / float(np.sum((force_n - force_n.mean()) ** 2)))
    slope = float(solved[0])
    # A stiffness that is known worse than by 30 % could not be told from one that ``check_loop``
    # refuses.
    if slope <= 0 or sigma > _TOLERANCE * slope:
        raise LoopFitRefused(f"travel grows by {slope * 1e6:.3f} ± {sigma * 1e6:.3f} µm per newton")
    return StiffnessFit(1 / slope, float(sigma) / slope**2, float(np.abs(errors).max()))


def fit_loop(time_s: Array, push_n: Array, press_n: Array, damping_n_s_m: float) -> LoopFigures:
    """Stiffness and dead time from a closed loop after a step of its push; arrays (n,).

    The arm moves by the sum of the differences between push and force, times T/S; the force follows
    it by the delay of the loop. Raises ``LoopFitRefused`` or ``LoopNotMeasured``.
    """
    period_s = float(np.median(np.diff(time_s)))
    # Travel of the arm times S, but for a constant: with the damping S its speed is the difference
    # of push and force over S.
    done = np.cumsum(period_s * (push_n - press_n))

    def solved(dead_s: float) -> tuple[float, float]:
        # Half a tick later, because a setpoint is held for a whole tick.
        late = np.interp(time_s - dead_s - period_s / 2, time_s, done, left=0.0)
        design = np.stack([late, np.ones_like(late)], axis=1)
        slope, offset = np.linalg.lstsq(design, press_n, rcond=None)[0]
        errors = slope * late + offset - press_n
        return float(np.mean(errors**2)), float(slope)

    # Bounded: a loop whose dead time is a quarter of the record would not have settled in it.
    most_s = 0.25 * float(time_s[-1] - time_s[0])
    found = minimize_scalar(
        lambda dead_s: solved(dead_s)[0], bounds=(1e-4, most_s), method="bounded"
    )
    residual = float(np.sqrt(found.fun))
    if residual > _GREATEST_RESIDUAL * float(np.std(press_n)):
        raise LoopFitRefused(f"a loop with dead time is {residual:.2f} N off what was felt")
    delay_s = float(found.x)
    dead_s = delay_s + TICKS_OF_THE_LOOP * period_s
    return LoopFigures(solved(delay_s)[1] * damping_n_s_m, dead_s)


def check_loop(calculated: LoopFigures, fitted: LoopFigures) -> None:
    """Raise ``LoopFitRefused`` when stiffness times dead time is off by more than 30 %."""
    ratio = fitted.loop_n_s_m / calculated.loop_n_s_m
    if abs(ratio - 1.0) > _TOLERANCE:
        raise LoopFitRefused(
            f"the loop behaves like k theta = {fitted.loop_n_s_m:.3g} N s/m, calculated were "
            f"{calculated.loop_n_s_m:.3g}: {100 * (ratio - 1):+.0f} %"
        )


def check_step(
    time_s: Array, rise_n: Array, step_n: float, dead_s: float, noise_n: float = 0.0
) -> None:
    """Raise ``LoopFitRefused`` for a step that overshoots 15 % or settles after six dead times.

    ``rise_n`` (n,) is the force above that before the step, of standard deviation ``noise_n``, and
    ``time_s`` (n,) the time since. Settled means within 10 % of the step, beyond the noise.
    """
    over = (float(rise_n.max()) - step_n - 3.0 * noise_n) / step_n
    if over > _GREATEST_OVERSHOOT:
        raise LoopFitRefused(f"a step of {step_n:.1f} N overshoots by {100 * over:.0f} %")
    outside = np.flatnonzero(np.abs(rise_n - step_n) > _SETTLED_SHARE * step_n + 3.0 * noise_n)
    settled_s = float(time_s[outside[-1]]) if len(outside) else 0.0
    if settled_s > _SETTLED_DEAD_TIMES * dead_s:
        raise LoopFitRefused(
            f"a step settles in {settled_s * 1e3:.0f} ms, {_SETTLED_DEAD_TIMES:.0f} dead times are "
            f"{_SETTLED_DEAD_TIMES * dead_s * 1e3:.0f} ms"
        )
