"""Curves that no plugging can have in the units, signs and axes that their columns stand for."""

import numpy as np

from cellctl.force.contact.recorded_units import (
    impossible_depths,
    impossible_forces,
    impossible_sampling,
    impossible_speed,
    unread_component,
)
from cellctl.force.contact.recorded_zero import FEWEST_FREE, zero_off
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
_FREE_SHARE = 0.25
"""A mean force above the touch matters from this share of what is allowed before the springs on."""
_FREE_MOMENT_SHARE = 0.5
"""The same of moments, of what moves the force to the bound of the centre of pressure as soon as
that is judged, and of what is allowed about z before the springs. Means of the fake cells are a
third of it."""


def require_possible_curve(curve: InsertionCurve, socket: Connector) -> None:
    """Raise ``InsertionCurveInvalid`` for numbers that no plugging can have in these columns."""
    seat_m, most_n = socket.seat_depth_m, socket.force_n[1]
    for why in (
        _other_way(curve, seat_m),
        impossible_sampling(curve.t_s, _TIME),
        impossible_depths(curve.depth_m, seat_m, _DEPTH),
        impossible_speed(curve.t_s, curve.depth_m, _TIME),
        impossible_forces(curve.force_n, most_n, _FORCES),
        unread_component(curve.force_n, _FORCES) or unread_component(curve.moment_n_m, _MOMENTS),
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
    if len(_free(curve, limits)) >= FEWEST_FREE:
        return None
    return (
        f"Nothing was recorded higher than {limits.entry_height_m / MM:g} mm over the touch, where "
        f"no force acts. So nothing shows that {', '.join(_FORCES)} were tared, and all of the "
        "verdict rests on it."
    )


def _not_tared(curve: InsertionCurve, socket: Connector) -> str | None:
    """A zero that is off hides what is felt before the springs, or shows what was not; one of the
    moments moves the contact that is suspected."""
    limits = InsertionLimits.of(socket)
    side_n, axial_n = (_FREE_SHARE * one for one in (limits.entry_side_n, limits.entry_axial_n))
    tilting_n_m = _FREE_MOMENT_SHARE * limits.least_pressure_n * limits.centre_of_pressure_m
    turning_n_m = _FREE_MOMENT_SHARE * limits.entry_moment_z_n_m
    allowed = (side_n, side_n, axial_n, tilting_n_m, tilting_n_m, turning_n_m)
    units = ["N"] * len(_FORCES) + ["N·m"] * len(_MOMENTS)
    columns = zip((*_FORCES, *_MOMENTS), units, allowed, strict=True)
    where = f"higher than {limits.entry_height_m / MM:g} mm over the touch"
    return zero_off(_free(curve, limits), columns, where)


def _free(curve: InsertionCurve, limits: InsertionLimits) -> Array:
    """Forces and moments above the touch, on the way in; shape (n, 6)."""
    way_in = slice(0, int(np.argmax(curve.depth_m)) + 1)
    above = curve.depth_m[way_in] < -limits.entry_height_m
    return np.hstack([curve.force_n[way_in][above], curve.moment_n_m[way_in][above]])


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
