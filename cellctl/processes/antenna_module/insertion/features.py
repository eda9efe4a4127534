"""What a whole insertion curve shows, in a few numbers."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import MM, Array
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits, InsertionPhase

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class InsertionFeatures:
    """All largest values are of means over a few samples."""

    early_axial_n: float
    """Largest resistance in the entry, before the contact springs."""
    early_side_n: float
    early_moment_n_m: float
    """Largest moment about the axes across the insertion there."""
    early_pressure_m: tuple[float, float] | None
    """Centre of pressure when that resistance was largest: where it touched. None without one."""
    side_n: float
    """Largest of the whole insertion."""
    moment_z_n_m: float
    pressure_m: float
    """Centre of pressure from the middle, once the axial force makes it certain: where it comes
    nearest to what is allowed, or exceeds that most."""
    pressure_limit_m: float
    """What is allowed at that depth."""
    peak_n: float
    """Largest resistance before the seat."""
    total_n: float
    """Largest resistance altogether."""
    seat_depth_m: float | None
    """Where the force rose as it does at a seat; None when it did not."""
    depth_m: float
    """Deepest point reached."""

    def to_record(self) -> dict[str, float | list[float] | None]:
        """Plain data; lengths in mm."""
        record: dict[str, float | list[float] | None] = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name.endswith("_m") and not field.name.endswith("_n_m"):
                in_mm = (
                    None
                    if value is None
                    else [x / MM for x in value]
                    if isinstance(value, tuple)
                    else value / MM
                )
                record[f"{field.name.removesuffix('_m')}_mm"] = in_mm
            else:
                record[field.name] = value
        return record


def features_of(
    curve: InsertionCurve, limits: InsertionLimits, mean_of: int = 5
) -> InsertionFeatures:
    """The features; means over ``mean_of`` samples. A phase that was not reached gives zeros."""
    force, moment = _smooth(curve.force_n, mean_of), _smooth(curve.moment_n_m, mean_of)
    axial = force[:, 2]
    side = np.hypot(force[:, 0], force[:, 1])
    early = np.array([limits.phase_at(depth) is InsertionPhase.ENTRY for depth in curve.depth_m])
    seat = _seat(curve.depth_m, axial, limits)
    pressure_m, pressure_limit_m = _pressure(curve, limits)
    before_seat = (
        np.ones(len(axial), dtype=bool) if seat is None else curve.depth_m < curve.depth_m[seat]
    )
    return InsertionFeatures(
        early_axial_n=_largest(axial[early]),
        early_side_n=_largest(side[early]),
        early_moment_n_m=_largest(np.hypot(moment[early, 0], moment[early, 1])),
        early_pressure_m=_touch(axial, moment, early, limits),
        side_n=_largest(side),
        moment_z_n_m=_largest(np.abs(moment[:, 2])),
        pressure_m=pressure_m,
        pressure_limit_m=pressure_limit_m,
        peak_n=_largest(axial[before_seat]),
        total_n=_largest(axial),
        seat_depth_m=None if seat is None else float(curve.depth_m[seat]),
        depth_m=float(curve.depth_m.max()),
    )


def _smooth(values: Array, mean_of: int) -> Array:
    """Means of the last ``mean_of`` samples; at the beginning, of as many as there are."""
    summed = np.cumsum(values, axis=0)
    summed[mean_of:] -= summed[:-mean_of].copy()
    counts = np.minimum(np.arange(1, len(values) + 1), mean_of)
    return np.asarray(summed / counts[:, None])


def _largest(values: Array) -> float:
    return float(values.max()) if len(values) else 0.0


def _touch(
    axial: Array, moment: Array, early: Mask, limits: InsertionLimits
) -> tuple[float, float] | None:
    """Where the plug stood when the resistance of the entry was largest."""
    if not early.any():
        return None
    at = int(np.flatnonzero(early)[np.argmax(axial[early])])
    if axial[at] < limits.entry_axial_n:
        return None
    return float(-moment[at, 1] / axial[at]), float(moment[at, 0] / axial[at])


def _pressure(curve: InsertionCurve, limits: InsertionLimits) -> tuple[float, float]:
    period_s = float(np.median(np.diff(curve.t_s)))
    mean_of = max(1, round(limits.pressure_mean_s / period_s))
    axial = _smooth(curve.force_n, mean_of)[:, 2]
    moment = _smooth(curve.moment_n_m, mean_of)
    sliding = curve.depth_m >= limits.spring_depth_m
    sure = sliding & (axial > limits.least_pressure_n)
    if not sure.any():
        return 0.0, limits.at(limits.seat_depth_m).centre_of_pressure_m
    lever_m = np.hypot(moment[sure, 0], moment[sure, 1]) / axial[sure]
    allowed_m = np.array([limits.at(depth).centre_of_pressure_m for depth in curve.depth_m[sure]])
    worst = int(np.argmax(lever_m / allowed_m))
    return float(lever_m[worst]), float(allowed_m[worst])


def _seat(depth_m: Array, axial: Array, limits: InsertionLimits) -> int | None:
    """Index where the force has risen by the seat's rise within the seat's depth."""
    # The contact springs rise as high, but before that; a seat among them counts as none.
    deep = np.flatnonzero(depth_m >= limits.spring_depth_m + limits.spring_rise_m)
    least = 0
    for at in deep:
        while depth_m[deep[least]] < depth_m[at] - limits.seat_within_m:
            least += 1
        window = axial[deep[least] : at + 1]
        if axial[at] - window.min() > limits.seat_rise_n:
            return int(deep[least] + int(window.argmin()))
    return None
