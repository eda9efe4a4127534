"""Motion of an arm along a path: how far at a time, and which joint angles there."""

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import RigidTransform, Rotation, Slerp

from fakes.scenario_file.sections import Chain
from fakes.world.arm import inverse
from fakes.world.frames import Array, distance

_KNOT_M = 0.025
"""Distance between solutions of the inverse kinematics on a straight path. Over 40 random moves of
the main arm the spline between them leaves the line by 1.3 µm; at 50 mm it would be 16 µm."""
_M_PER_RAD = 0.25
"""A pure turn is timed as if the flange moved this far for every radian."""


@dataclass(frozen=True, slots=True)
class Profile:
    """Trapezoid of speed over a length, from standstill to standstill; may be cut short."""

    start_s: float
    length: float
    speed: float
    acceleration: float
    stop_s: float = np.inf
    """When braking begins early."""
    braking: float = np.inf
    # Asked for several times in each millisecond of every arm.
    _peak: float = field(init=False, repr=False)
    _ramp_s: float = field(init=False, repr=False)
    _full_end_s: float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        peak = min(self.speed, math.sqrt(self.length * self.acceleration))
        ramp_s = peak / self.acceleration
        end_s = self.start_s + self.length / peak + ramp_s if self.length > 0 else self.start_s
        object.__setattr__(self, "_peak", peak)
        object.__setattr__(self, "_ramp_s", ramp_s)
        object.__setattr__(self, "_full_end_s", end_s)

    @property
    def end_s(self) -> float:
        """Time of standstill."""
        if self.stop_s >= self._full_end_s:
            return self._full_end_s
        return self.stop_s + self._full_rate(self.stop_s) / self.braking

    @property
    def cut_short(self) -> bool:
        """True when the motion ends before its target."""
        return self.stop_s < self._full_end_s

    def at(self, time_s: float) -> float:
        """Distance along the path."""
        if time_s <= self.stop_s or not self.cut_short:
            return self._full_at(time_s)
        after_s = min(time_s, self.end_s) - self.stop_s
        rate = self._full_rate(self.stop_s)
        return self._full_at(self.stop_s) + rate * after_s - 0.5 * self.braking * after_s**2

    def stopped_from(self, time_s: float, braking: float) -> "Profile":
        """The same motion, braked on its path from a time on; an earlier brake stays."""
        if time_s >= self.stop_s:
            return self
        return replace(self, stop_s=max(time_s, self.start_s), braking=braking)

    def _full_at(self, time_s: float) -> float:
        since_s, left_s = time_s - self.start_s, self._full_end_s - time_s
        if since_s <= 0 or self.length <= 0:
            return 0.0
        if left_s <= 0:
            return self.length
        if since_s < self._ramp_s:
            return 0.5 * self.acceleration * since_s**2
        if left_s < self._ramp_s:
            return self.length - 0.5 * self.acceleration * left_s**2
        return self._peak * (since_s - 0.5 * self._ramp_s)

    def _full_rate(self, time_s: float) -> float:
        since_s, left_s = time_s - self.start_s, self._full_end_s - time_s
        if since_s <= 0 or left_s <= 0:
            return 0.0
        return min(self._peak, self.acceleration * min(since_s, left_s))


class Path(Protocol):
    """Gives the joint angles along a motion."""

    length: float
    """Length in the unit of the profile."""
    travel_m: float
    """Travel that counts for the repeatability error."""

    def joints(self, along: float) -> Array:
        """Joint angles at a distance along the path."""
        ...


class JointPath:
    """All joints together, straight in joint space; the length is seconds at rated speed."""

    def __init__(self, start_rad: Array, target_rad: Array, rated_rad_s: Array) -> None:
        self._start, self._delta = start_rad, target_rad - start_rad
        self.length = float((np.abs(self._delta) / rated_rad_s).max())
        self.travel_m = float(np.abs(self._delta).sum())

    def joints(self, along: float) -> Array:
        """Joint angles at a distance along the path."""
        if self.length == 0:
            return self._start
        return self._start + self._delta * (along / self.length)


class LinearPath:
    """The flange in a straight line; the length is metres. Raises ``OutOfReachError``."""

    def __init__(self, chain: Chain, start: RigidTransform, target: RigidTransform, near: Array):
        self.length = way_m(*distance(start, target))
        self.travel_m = self.length
        ratios = np.linspace(0, 1, max(4, int(np.ceil(self.length / _KNOT_M)) + 1))
        ends = Rotation.concatenate([start.rotation, target.rotation])
        rotations = Slerp([0.0, 1.0], ends)(ratios)
        places = start.translation + np.outer(ratios, target.translation - start.translation)
        self.knots = np.empty((len(ratios), 6))
        for index, place in enumerate(places):
            pose = RigidTransform.from_components(place, rotations[index])
            near = self.knots[index] = inverse(chain, pose, near)
        # Asked for in every millisecond: a call of the spline itself costs five times as much.
        self._cubics = CubicSpline(ratios, self.knots).c
        self._places = ratios

    def joints(self, along: float) -> Array:
        """Joint angles at a distance along the path."""
        ratio = along / self.length if self.length > 0 else 1.0
        last = self._cubics.shape[1] - 1
        index = min(max(int(ratio * (last + 1)), 0), last)
        cubic, square, slope, start = self._cubics[:, index]
        beyond = ratio - self._places[index]
        return np.asarray(((cubic * beyond + square) * beyond + slope) * beyond + start)


class StreamSegment:
    """The way from one streamed setpoint to the next, straight in joint space; lengths are metres.

    It may be followed beyond its end, as an arm does that is told to stop while it moves.
    """

    def __init__(self, start_rad: Array, target_rad: Array, length_m: float) -> None:
        self._start, self._rate = start_rad, (target_rad - start_rad) / length_m
        self.length = length_m
        self.travel_m = length_m

    def joints(self, along: float) -> Array:
        """Joint angles at a distance along the path."""
        return self._start + self._rate * along

    def lengthened(self, start_along: float, length_m: float) -> "StreamSegment":
        """The same direction from a point of this segment on, over another length."""
        start_rad = self.joints(start_along)
        return StreamSegment(start_rad, start_rad + self._rate * length_m, length_m)


def way_m(distance_m: float, angle_rad: float) -> float:
    """Length of a motion: the distance, or the angle as a distance, whichever is longer."""
    return max(distance_m, angle_rad * _M_PER_RAD)
