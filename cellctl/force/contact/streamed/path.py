"""Goes along a chain of points with bounded speed and acceleration, tick by tick."""

import numpy as np

from cellctl.geometry.pose import Array


class PathFollower:
    """Begins at rest at the first point."""

    def __init__(self, points: Array, lengths: Array, acceleration: float, period_s: float) -> None:
        """``points`` (n, d); ``lengths`` (n − 1,) of the stretches, in whatever unit speeds have.

        ``acceleration`` in the same unit per s².
        """
        self._points = points
        self._marks = np.concatenate([[0.0], np.cumsum(lengths)])
        """Length from the first point to each of them."""
        self._acceleration, self._period_s = acceleration, period_s
        self._at = 0.0
        """Length from the first point to where it is."""
        self.speed = 0.0
        """Present speed, in the unit of the lengths per second; negative while it goes back."""

    @property
    def remaining(self) -> float:
        """Length that is left."""
        return float(self._marks[-1] - self._at)

    @property
    def arrived(self) -> bool:
        """True at the last point."""
        # But for rounding; the first term serves a path of no length.
        return self.remaining <= 1e-12 + 1e-9 * float(self._marks[-1])

    @property
    def point(self) -> Array:
        """Where it is, shape (d,)."""
        columns = [np.interp(self._at, self._marks, column) for column in self._points.T]
        return np.array(columns)

    def step(self, speed: float) -> Array:
        """The point of the next tick on the way to ``speed``; it comes to rest at the last point.

        A negative speed goes back along the path.
        """
        # The greatest speed v from which it can still stop at the end, losing ``step`` of speed in
        # each tick: v T / 2 + v² / 2a is the way that is left.
        step = self._acceleration * self._period_s
        reach = np.sqrt(step**2 / 4 + 2.0 * self._acceleration * self.remaining) - step / 2
        # Never slower than one tick can make up for: ``reach`` goes to nought with the way that is
        # left, and the end would only be approached for ever.
        return self._move(min(speed, max(float(reach), min(step, speed))))

    def hold(self) -> Array:
        """The same point again, at half the speed."""
        self.speed /= 2
        return self.point

    def brake(self) -> Array:
        """The point of the next tick on the way to standstill."""
        return self._move(0.0)

    def _move(self, wanted: float) -> Array:
        most = self._acceleration * self._period_s
        speed = self.speed + float(np.clip(wanted - self.speed, -most, most))
        at = float(np.clip(self._at + speed * self._period_s, 0.0, self._marks[-1]))
        # What was really done: an end of the path leaves no speed behind.
        self.speed = (at - self._at) / self._period_s
        self._at = at
        return self.point


def straight(begin: Array, end: Array, lever_m: float) -> tuple[Array, Array]:
    """Points and lengths of a straight way between two poses of shape (6,).

    A turn counts as the way of a point at ``lever_m``, so that a speed bounds shift and turn.
    """
    way = end - begin
    length = max(float(np.linalg.norm(way[:3])), lever_m * float(np.linalg.norm(way[3:])))
    return np.stack([begin, end]), np.array([length])
