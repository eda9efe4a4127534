"""The limits that the guard watches in each phase, and the fault that belongs to each trip."""

import numpy as np

from cellctl.cell.guarded_motion.guard_limits import Sensing, guard_limits
from cellctl.errors.base import CellError
from cellctl.geometry.pose import Array
from cellctl.guard.limits import CusumTouch, GuardLimits
from cellctl.guard.report import GuardTrip
from cellctl.processes.deck_to_frame.faults import LateralLoad, MatingOverforce
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings

_ALONG = 2


def travel_limits(settings: MatingSettings) -> GuardLimits:
    """Fast travel: nothing but inertia may be felt, in any direction."""
    # Never beyond the limits of contact, whatever a recipe gives for inertia.
    along_n = min(settings.fast_limit_n, settings.abort_force_n)
    return _limits(settings, along_n, min(along_n, settings.max_lateral_n))


def touch_limits(settings: MatingSettings) -> GuardLimits:
    """Guarded travel: stop at the touch, and at the limits of contact if that fails."""
    touch = CusumTouch(settings.touch.drift_n, settings.touch.threshold_n)
    return _limits(settings, settings.abort_force_n, settings.max_lateral_n, touch)


def contact_limits(settings: MatingSettings) -> GuardLimits:
    """Limits while creeping, holding and relaxing."""
    return _limits(settings, settings.abort_force_n, settings.max_lateral_n)


def leaving_limits(settings: MatingSettings, wrench: Array) -> GuardLimits:
    """Backing off: what presses, shape (6,), may go but not grow, and nothing may pull.

    The wrench counts from the stand-off. ``fast_limit_n`` is what inertia and friction may make.
    """
    growth = np.repeat([settings.fast_limit_n, settings.max_moment_n_m], 3)
    fx, fy, fz, mx, my, mz = (float(value) for value in np.abs(wrench) + growth)
    # The zero is that of the stand-off, so a force of the other sign can only be a pull.
    pull = CusumTouch(settings.fast_limit_n, settings.touch.threshold_n, axis=_ALONG, sign=-1.0)
    return guard_limits(
        (fx, fy, fz, mx, my, mz),
        _sensing(settings),
        touch=pull,
        filter_s=settings.filter_delay_s,
    )


def fault_of(trip: GuardTrip, settings: MatingSettings) -> CellError:
    """The fault of a trip that ends an attempt."""
    # Along the approach the figures of the plan were wrong, which costs calibrations
    # (``calibrations.py``); across it the parts do not fit.
    if trip.force and trip.component == _ALONG:
        return MatingOverforce(f"abort limit {settings.abort_force_n:.0f} N: {trip}")
    if trip.force:
        return LateralLoad(str(trip))
    return trip.fault()


def _limits(
    settings: MatingSettings, along_n: float, across_n: float, touch: CusumTouch | None = None
) -> GuardLimits:
    moment_n_m = settings.max_moment_n_m
    return guard_limits(
        (across_n, across_n, along_n, moment_n_m, moment_n_m, moment_n_m),
        _sensing(settings),
        touch=touch,
        filter_s=settings.filter_delay_s,
    )


def _sensing(settings: MatingSettings) -> Sensing:
    return Sensing(1.0 / settings.sample_period_s, settings.stale_s, settings.flange_age_s)
