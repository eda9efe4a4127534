"""Recorded insertions whose numbers cannot be in the units that their columns name.

Each function gives the reason in words, with the column and what is expected, or None. The bounds
are those of what arms, sensors and parts can do, far from the values of any recording: numbers
beyond them are in another unit, numbers within them need not be in the right one.
"""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.pose import MM, Array

_RARELY_S, _OFTEN_S = 0.5, 10e-6
"""Longest and shortest time between two samples: an arm that presses at 1 mm/s goes half a
millimetre in the one, and no force sensor of an arm has 100 000 samples a second."""
_SLOWEST_M_S, _FASTEST_M_S = 0.01e-3, 0.5
"""Speeds of the way in: a tenth of the slowest touch (docs/mating.md), and twice what an arm may do
within reach of a person (ISO 10218-1)."""
_MIDDLE = (0.2, 0.8)
"""Part of the way that tells its speed: what waits before and after it does not count."""
_NOT_IN, _NOT_ABOVE, _TOO_DEEP = 0.003, 0.02, 3.0
"""Depths over that of the seat. A part that stands on its hole is pressed in by more than the first
by the arm that yields, and one that comes from above begins higher than the second. No hole is more
than three times as deep as its drawing."""
_HARDLY_PRESSES, _CRUSHES = 0.002, 100.0
"""Greatest force over that of a good insertion: the first is less than the noise of a sensor that
measures such a force, the second breaks every part."""


def impossible_sampling(time_s: Array, column: str) -> str | None:
    """Of samples at rising times, shape (n,)."""
    usual_s = float(np.median(np.diff(time_s)))
    if usual_s > _RARELY_S:
        return (
            f"{column}: {usual_s:.3g} s between samples, in which an arm that presses at 1 mm/s "
            f"goes {usual_s:.3g} mm unseen; expected at most {_RARELY_S:g} s: another unit, such "
            "as milliseconds for seconds?"
        )
    if usual_s < _OFTEN_S:
        return (
            f"{column}: {usual_s:.3g} s between samples, and no force sensor of an arm has so many;"
            f" expected at least {_OFTEN_S:g} s: another unit, such as seconds for milliseconds?"
        )
    return None


def impossible_speed(time_s: Array, depth_m: Array, column: str) -> str | None:
    """Of times, shape (n,), at depths, shape (n,), that are possible themselves."""
    speed_m_s = _speed_m_s(time_s, depth_m)
    if speed_m_s is None or _SLOWEST_M_S <= speed_m_s <= _FASTEST_M_S:
        return None
    slow = speed_m_s < _SLOWEST_M_S
    bound = f"at least {_SLOWEST_M_S / MM:g}" if slow else f"at most {_FASTEST_M_S / MM:g}"
    units = "milliseconds for seconds" if slow else "seconds for milliseconds"
    return (
        f"{column}: by it the part went in at {speed_m_s / MM:.3g} mm/s, and no arm that feels its "
        f"way does; expected {bound} mm/s: another unit, such as {units}?"
    )


def impossible_depths(depth_m: Array, seat_m: float, column: str) -> str | None:
    """Of depths, shape (n,), on the way to a seat at ``seat_m``."""
    deepest_m, farthest_m = float(depth_m.max()), float(np.abs(depth_m).max())
    if deepest_m > _TOO_DEEP * seat_m:
        return (
            f"{column} reaches {deepest_m / MM:.4g} mm, and the seat of the drawing lies at "
            f"{seat_m / MM:.4g} mm; expected at most {_TOO_DEEP:g} times that: another unit, such "
            "as micrometres for millimetres?"
        )
    if deepest_m < _NOT_IN * seat_m and farthest_m < _NOT_ABOVE * seat_m:
        return (
            f"{column} stays within {farthest_m / MM:.4g} mm of the first touch, of a seat at "
            f"{seat_m / MM:.4g} mm; expected a way in, or one from above: another unit, such as "
            "metres for millimetres, or only the touch of a part that did not go in?"
        )
    return None


def impossible_forces(force_n: Array, most_n: float, columns: Sequence[str]) -> str | None:
    """Of forces, shape (n, 3), where a good insertion takes at most ``most_n``."""
    greatest_n, names = float(np.abs(force_n).max()), ", ".join(columns)
    if greatest_n < _HARDLY_PRESSES * most_n:
        return (
            f"{names}: at most {greatest_n:.3g} N, less than the noise of a sensor for the "
            f"{most_n:g} N of a good insertion; expected at least {_HARDLY_PRESSES * most_n:.3g} "
            "N: another unit, such as kilonewtons for newtons, or a sensor that was not read?"
        )
    if greatest_n > _CRUSHES * most_n:
        return (
            f"{names}: up to {greatest_n:.3g} N, which breaks a part that takes {most_n:g} N when "
            f"all is good; expected at most {_CRUSHES * most_n:.3g} N: another unit, such as "
            "millinewtons for newtons?"
        )
    return None


def unread_component(wrench: Array, columns: Sequence[str]) -> str | None:
    """Of forces and moments, shape (n, k): one that never changes was not measured.

    What is judged by it would pass as if nothing had acted.
    """
    still = [
        f"{name} is {values[0]:g}"
        for name, values in zip(columns, wrench.T, strict=True)
        if np.ptp(values) == 0.0
    ]
    if not still:
        return None
    return (
        f"{', '.join(still)} in all {len(wrench)} samples; expected at least the noise of a "
        "sensor: a component that was not read, or rounded away?"
    )


def _speed_m_s(time_s: Array, depth_m: Array) -> float | None:
    """Of the middle of the way in; None where the recording does not go in."""
    low_m, high_m = depth_m.min(), depth_m.max()
    first_m, last_m = (low_m + share * (high_m - low_m) for share in _MIDDLE)
    deepest = int(np.argmax(depth_m))
    before = np.flatnonzero(depth_m[: deepest + 1] <= first_m)
    if not before.size:
        return None
    begin = int(before[-1])
    end = begin + int(np.argmax(depth_m[begin:] >= last_m))
    way_s = float(time_s[end] - time_s[begin])
    return float(depth_m[end] - depth_m[begin]) / way_s if way_s > 0.0 else None
