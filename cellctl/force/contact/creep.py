"""Creep to the target force: an admittance in small moves, with the force read at standstill.

Law: ``M dv/dt + S v = F_ref − F`` along the approach. A move takes effect once per period T (dead
time, move, settling, reading), which is far longer than the arm's own dynamics. So each step starts
and ends at rest and sees a spring: ``F(x + d) = F(x) + k d``. Taking the contact force of the
*next* instant into the law (backward Euler, implicit in F as well as in v) gives the step

    d = T (F_ref − F) / (S + M/T + T k_hat)

Stability: the error e = F_ref − F becomes (1 − T k/(S + M/T + T k_hat)) e with each step. It
shrinks without changing sign when ``k ≤ k_hat + S/T + M/T²``, and is stable up to twice that.
(Explicit Euler has no k_hat in the denominator and needs S > T k/2.) So with k_hat an upper bound
of the stiffness the force never overshoots, whatever T is. As the steps show how stiff the contact
really is, k_hat follows: downwards by at most half in each step, upwards at once, because too small
a value overshoots and too great a value only takes longer.

An arm does not go exactly where it is sent, and contact may stiffen while it closes. A second bound
keeps the force below ``abort_n`` in spite of both:
``F + min(k_max, 2 k_hat) (d + 3 sigma) <= abort``.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, slots=True)
class CreepLaw:
    """Constants of one creep."""

    reference_n: float
    """F_ref: the middle of the window the force must end in."""
    done_low_n: float
    done_high_n: float
    damping_n_s_m: float
    """Damping S of the law."""
    mass_kg: float
    """Virtual mass M of the law."""
    period_s: float
    """T: the time that one step takes altogether."""
    stiffness_n_m: float
    """Upper bound of arm and contact in series."""
    greatest_step_m: float
    smallest_step_m: float
    """A smaller step is within the noise of its reading and the resolution of the controller."""
    force_sigma_n: float
    """Standard deviation of a reading at standstill."""
    abort_n: float
    """No step forwards may be able to pass this force."""
    step_sigma_m: float
    """Standard deviation of the length of a step: the arm's own error of every single move."""
    stiffening_ratio: float = 2.0
    """Largest ratio of the stiffness at the end of a step to that of the steps before."""
    stiffness_margin_ratio: float = 1.25
    """k_hat stays this much above the stiffness that the steps have shown."""


@dataclass(frozen=True, slots=True)
class CreepState:
    """The state of the creep after the steps so far."""

    stiffness_n_m: float
    """Estimate k_hat of the stiffness."""
    force_n: float
    travel_m: float
    anchor_force_n: float
    anchor_travel_m: float
    """Force and travel from which the stiffness is being measured."""
    steps: int = 0


def begin(
    law: CreepLaw, force_n: float, travel_m: float, shown_n_m: float | None = None
) -> CreepState:
    """State before the first step; ``shown_n_m`` is the stiffness an earlier creep has measured."""
    stiffness = law.stiffness_n_m
    if shown_n_m is not None:
        stiffness = min(stiffness, law.stiffness_margin_ratio * shown_n_m)
    return CreepState(stiffness, force_n, travel_m, force_n, travel_m)


def done(law: CreepLaw, state: CreepState) -> bool:
    """True when the force lies in the window."""
    return law.done_low_n <= state.force_n <= law.done_high_n


def next_step(law: CreepLaw, state: CreepState) -> float:
    """Length of the next move (m) within its bounds, positive forwards, into the contact."""
    error_n = law.reference_n - state.force_n
    resistance = law.damping_n_s_m + law.mass_kg / law.period_s
    step_m = law.period_s * error_n / (resistance + law.period_s * state.stiffness_n_m)
    stiffest = min(law.stiffness_n_m, law.stiffening_ratio * state.stiffness_n_m)
    # The contact stiffens while it closes, and no move is exactly as long as commanded. Both are
    # allowed for before the step is made, because the force is read only after it.
    furthest_m = (law.abort_n - state.force_n) / stiffest - 3.0 * law.step_sigma_m
    bound_m = min(law.greatest_step_m, max(furthest_m, law.smallest_step_m))
    step_m = float(np.clip(step_m, -law.greatest_step_m, bound_m))
    if abs(step_m) < law.smallest_step_m:
        # The force is outside its window, so standing still would never end. The smallest step is
        # the least that the controller carries out.
        step_m = float(np.copysign(law.smallest_step_m, error_n))
    return step_m


def after_step(law: CreepLaw, state: CreepState, force_n: float, travel_m: float) -> CreepState:
    """State after a step was driven and the force read again at standstill.

    The stiffness is corrected as soon as the steps add up to a travel that is long compared with
    the arm's own error. Noise of force and length is counted as stiffness, so that the estimate
    stays an upper bound. After a longer travel the measurement starts again at the present point,
    because contact stiffens as it closes.
    """
    after = replace(state, force_n=force_n, travel_m=travel_m, steps=state.steps + 1)
    moved_m = abs(travel_m - state.anchor_travel_m)
    unsure_m = 3.0 * law.step_sigma_m
    # From twice the error of the way on, that error makes the estimate at most twice as stiff.
    if moved_m <= 2.0 * unsure_m:
        return after
    # The difference of two readings scatters by √2 of one. Adding three sigmas of it keeps the
    # estimate on the safe side: too stiff costs a few steps, too soft overshoots.
    noise_n = 3.0 * np.sqrt(2.0) * law.force_sigma_n
    rose_n = abs(force_n - state.anchor_force_n)
    shown = law.stiffness_margin_ratio * (rose_n + noise_n) / (moved_m - unsure_m)
    # At most halved in one step: a single soft reading, such as that of a part settling, must not
    # open the way for a long step onto a stiff seat.
    stiffness = min(max(shown, 0.5 * state.stiffness_n_m), law.stiffness_n_m)
    after = replace(after, stiffness_n_m=float(stiffness))
    # After six times the error, what it adds is a fifth: waiting on would bring little, and mix in
    # how soft the contact was when it began to close.
    if moved_m <= 6.0 * unsure_m:
        return after
    return replace(after, anchor_force_n=force_n, anchor_travel_m=travel_m)
