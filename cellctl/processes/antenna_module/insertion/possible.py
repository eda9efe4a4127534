"""Curves that no plugging can have in the units, signs and axes that their columns stand for."""

import numpy as np

from cellctl.force.contact.recorded_units import (
    impossible_depths,
    impossible_forces,
    impossible_sampling,
    impossible_speed,
)
from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid
from cellctl.processes.antenna_module.insertion.curve import COLUMNS, InsertionCurve
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits

_TIME, _DEPTH, _FORCES, _MOMENTS = COLUMNS[0], COLUMNS[1], COLUMNS[2:5], COLUMNS[5:8]
_AWAY = 0.1
"""Share of the seat's depth by which a part that is plugged never moves out before its greatest
force."""
_SOME = 0.95
"""Quantile of the levers that is judged: single samples have noise."""
_FREE_SHARE, _FREE_SIGMAS, _FREE_SAMPLES = 0.25, 5.0, 20
"""A mean force above the touch is none of the noise beyond this share of what is allowed before the
springs and so many standard deviations of the mean; of fewer samples nothing is said."""


def require_possible_curve(curve: InsertionCurve, socket: Connector) -> None:
    """Raise ``InsertionCurveInvalid`` for numbers that no plugging can have in these columns."""
    seat_m, most_n = socket.seat_depth_m, socket.force_n[1]
    for why in (
        _other_way(curve, seat_m),
        impossible_sampling(curve.t_s, _TIME),
        impossible_depths(curve.depth_m, seat_m, _DEPTH),
        impossible_speed(curve.t_s, curve.depth_m, _TIME),
        impossible_forces(curve.force_n, most_n, _FORCES),
        _pulled_in(curve, socket.force_n[0]),
        _not_tared(curve, socket),
        _far_levers(curve, socket),
    ):
        if why is not None:
            raise InsertionCurveInvalid(why)


def _other_way(curve: InsertionCurve, seat_m: float) -> str | None:
    first_m = float(curve.depth_m[0])
    met_m = float(curve.depth_m[np.argmax(np.abs(curve.force_n[:, 2]))])
    if met_m > min(first_m, 0.0) - _AWAY * seat_m:
        return None
    return (
        f"{_DEPTH} falls from {first_m / MM:.4g} to {met_m / MM:.4g} mm until the greatest force; "
        "expected to rise into the socket: another sign?"
    )


def _pulled_in(curve: InsertionCurve, least_n: float) -> str | None:
    axial_n = curve.force_n[: int(np.argmax(curve.depth_m)) + 1, 2]
    if -axial_n.min() <= max(least_n, float(axial_n.max())):
        return None
    return (
        f"{_FORCES[2]} falls to {axial_n.min():.3g} N on the way in; expected a resistance to be "
        "positive: another sign, forces on the socket, or a tare of a loaded sensor?"
    )


def unknown_zero(curve: InsertionCurve, socket: Connector) -> str | None:
    """What is to be said of a curve that begins so late that nothing in it shows its zero."""
    limits = InsertionLimits.of(socket)
    if len(_free_n(curve, limits)) >= _FREE_SAMPLES:
        return None
    return (
        f"Nothing was recorded higher than {limits.entry_height_m / MM:g} mm over the touch, where "
        f"no force acts. So nothing shows that {', '.join(_FORCES)} were tared, and all of the "
        "verdict rests on it."
    )


def _not_tared(curve: InsertionCurve, socket: Connector) -> str | None:
    """A zero that is off hides what is felt before the springs, or shows what was not."""
    limits = InsertionLimits.of(socket)
    free_n = _free_n(curve, limits)
    if len(free_n) < _FREE_SAMPLES:
        return None
    mean_n, sigma_n = free_n.mean(axis=0), free_n.std(axis=0) / np.sqrt(len(free_n))
    for axis, allowed_n in enumerate(
        (limits.entry_side_n, limits.entry_side_n, limits.entry_axial_n)
    ):
        most_n = max(_FREE_SHARE * allowed_n, _FREE_SIGMAS * float(sigma_n[axis]))
        if abs(mean_n[axis]) > most_n:
            return (
                f"{_FORCES[axis]} is {mean_n[axis]:.3g} N in the mean higher than "
                f"{limits.entry_height_m / MM:g} mm over the touch, where no force acts; expected "
                f"within {most_n:.2g} N of 0: recorded without a tare, or a hose that pulls?"
            )
    return None


def _free_n(curve: InsertionCurve, limits: InsertionLimits) -> Array:
    """The forces above the touch, on the way in; shape (n, 3)."""
    way_in = slice(0, int(np.argmax(curve.depth_m)) + 1)
    return curve.force_n[way_in][curve.depth_m[way_in] < -limits.entry_height_m]


def _far_levers(curve: InsertionCurve, socket: Connector) -> str | None:
    across, axial_n = curve.moment_n_m[:, :2], curve.force_n[:, 2]
    sure = axial_n > InsertionLimits.of(socket).least_pressure_n
    if not sure.any():
        return None
    lever_m = np.linalg.norm(across[sure], axis=1) / axial_n[sure]
    usual_m, most_m = float(np.quantile(lever_m, _SOME)), float(np.hypot(*socket.outline_m))
    if usual_m <= most_m:
        return None
    return (
        f"{', '.join(_MOMENTS[:2])}: the force would act {usual_m / MM:.3g} mm beside the middle of"
        f" a connector that is {most_m / MM:.3g} mm across; expected on it: another unit, such as "
        "newton millimetres for newton metres, or moments about the sensor in place of the socket?"
    )
