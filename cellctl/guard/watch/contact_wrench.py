"""From a raw reading of the sensor to the contact wrench in the wrench frame, in plain floats.

    w = T (raw − b − A u) − tare

``u`` is the unit vector of gravity in sensor axes, ``A u + b`` the gravity compensation (what hangs
on the sensor weighs, and the sensor's own offset; ``cellctl.force.gravity`` identifies both), ``T``
moves the wrench from the sensor frame to the wrench frame, and ``tare`` is what was left at rest.
Signs are those of the surroundings acting on the part: a part that is pushed along +z of the wrench
frame has a positive Fz.

Everything but ``T raw`` changes only with the flange pose, which comes fifty times a second, while
samples come a thousand times. So the rest is kept as one constant, the bias, and a sample costs 27
multiplications, written out: a loop over rows measured three times slower, arrays fifteen times.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from cellctl.guard.limits import Six

Nine = tuple[float, ...]
"""A 3x3 matrix, row by row."""

ZERO: Six = (0.0,) * 6
_IDENTITY: Nine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class ContactWrenchModel:
    """Holds the present wrench frame, gravity compensation, flange orientation and tare."""

    def __init__(self, flange_R_sensor: Nine = _IDENTITY) -> None:
        self.gravity_compensated = False
        """True once a gravity compensation was set, be it one of zeros."""
        self._sensor_R_flange = _transposed(flange_R_sensor)
        self._load: list[Sequence[float]] = [(0.0, 0.0, 0.0)] * 6
        self._offset: Sequence[float] = ZERO
        # The direction for a robot that stands upright on the floor; a gravity compensation brings
        # its own.
        self._base_down: Sequence[float] = (0.0, 0.0, -1.0)
        self._flange_R_base = _IDENTITY
        self._tare: Six = ZERO
        self._bias: Six = ZERO
        self.set_wrench_frame(_IDENTITY, (0.0, 0.0, 0.0))

    def set_gravity_compensation(
        self, load: Sequence[Sequence[float]], offset: Sequence[float], base_down: Sequence[float]
    ) -> None:
        """Subtract ``A u + b`` from now on; drops the tare, which belonged to the old zero.

        ``load`` is A (6 rows of 3), ``offset`` is b (6), ``base_down`` the unit vector of gravity
        in the base of the robot.
        """
        self._load, self._offset, self._base_down = list(load), offset, base_down
        self.gravity_compensated = True
        self.set_tare(ZERO)

    def set_wrench_frame(self, rotation: Nine, translation_m: Sequence[float]) -> None:
        """Give wrenches about the origin and in the axes of this frame; drops the tare.

        The arguments are the two parts of ``sensor_T_wrench``.
        """
        a, b, c, d, e, f, g, h, i = self._wrench_R_sensor = _transposed(rotation)
        x, y, z = translation_m
        # The torque about the new origin is R (m − t × f), so forces enter it with −R [t]×.
        self._torque_of_force = (
            (c * y - b * z, a * z - c * x, b * x - a * y),
            (f * y - e * z, d * z - f * x, e * x - d * y),
            (i * y - h * z, g * z - i * x, h * x - g * y),
        )
        self.set_tare(ZERO)

    def set_flange(self, rotation: Nine) -> None:
        """Take the rotation matrix of ``base_T_flange`` as the present one."""
        self._flange_R_base = _transposed(rotation)
        self._update_bias()

    def set_tare(self, tare: Six) -> None:
        """Take this wrench, in the wrench frame, as zero from now on."""
        self._tare = tare
        self._update_bias()

    def untared(self, wrench: Six) -> Six:
        """A wrench as it was before the tare was subtracted from it."""
        a, b, c, d, e, f = (value + tare for value, tare in zip(wrench, self._tare, strict=True))
        return a, b, c, d, e, f

    def apply(self, raw: Six) -> Six:
        """The contact wrench of one raw reading: ``T raw`` less the bias."""
        fx, fy, fz, mx, my, mz = raw
        a, b, c, d, e, f, g, h, i = self._wrench_R_sensor
        (xa, xb, xc), (ya, yb, yc), (za, zb, zc) = self._torque_of_force
        p, q, r, s, t, u = self._bias
        return (
            a * fx + b * fy + c * fz - p,
            d * fx + e * fy + f * fz - q,
            g * fx + h * fy + i * fz - r,
            xa * fx + xb * fy + xc * fz + a * mx + b * my + c * mz - s,
            ya * fx + yb * fy + yc * fz + d * mx + e * my + f * mz - t,
            za * fx + zb * fy + zc * fz + g * mx + h * my + i * mz - u,
        )

    def _update_bias(self) -> None:
        """Work out ``T (b + A u) + tare`` for the present orientation of the flange."""
        down = _rotated(self._sensor_R_flange, _rotated(self._flange_R_base, self._base_down))
        load = [
            row[0] * down[0] + row[1] * down[1] + row[2] * down[2] + offset
            for row, offset in zip(self._load, self._offset, strict=True)
        ]
        # Cleared first: ``apply`` subtracts the bias, and here it has to give T times its argument
        # and nothing else.
        self._bias = ZERO
        fx, fy, fz, mx, my, mz = load
        transported = self.apply((fx, fy, fz, mx, my, mz))
        a, b, c, d, e, f = (
            value + tare for value, tare in zip(transported, self._tare, strict=True)
        )
        self._bias = (a, b, c, d, e, f)


@dataclass(frozen=True, slots=True)
class TareSums:
    """The outcome of a tare, in the wrench frame."""

    mean: Six
    sigma: Six
    """Standard deviation of the samples."""
    samples: int


class TareAverage:
    """Mean and scatter of the wrench over ``duration_s`` of sample time, summed sample by sample.

    The sums run over differences from the first sample: a load of kilonewtons with a noise of a
    newton would lose digits in a plain sum of squares.
    """

    def __init__(self, begin_s: float, duration_s: float) -> None:
        self._begin_s = begin_s
        self._end_s = begin_s + duration_s
        self._origin: Six | None = None
        self._count = 0
        self._sums = [0.0] * 6
        self._squares = [0.0] * 6

    def add(self, wrench: Six, time_s: float) -> TareSums | None:
        """Take a sample; the result once the time is over and two samples are in.

        Samples from before the request, still on their way when it came, do not count.
        """
        if time_s < self._begin_s:
            return None
        if self._origin is None:
            self._origin = wrench
        for index, (value, origin) in enumerate(zip(wrench, self._origin, strict=True)):
            difference = value - origin
            self._sums[index] += difference
            self._squares[index] += difference * difference
        self._count += 1
        # With one sample the scatter would divide by zero.
        return self._result(self._origin) if time_s >= self._end_s and self._count > 1 else None

    def _result(self, origin: Six) -> TareSums:
        count = self._count
        shifts = [total / count for total in self._sums]
        a, b, c, d, e, f = (value + shift for value, shift in zip(origin, shifts, strict=True))
        p, q, r, s, t, u = (
            # Rounding can make the difference slightly negative when all samples are equal. The
            # factor n/(n-1) makes the variance of a sample unbiased, since the mean is estimated
            # from the same values.
            math.sqrt(max(0.0, square / count - shift * shift) * count / (count - 1))
            for square, shift in zip(self._squares, shifts, strict=True)
        )
        return TareSums((a, b, c, d, e, f), (p, q, r, s, t, u), count)


def _transposed(matrix: Nine) -> Nine:
    a, b, c, d, e, f, g, h, i = matrix
    return a, d, g, b, e, h, c, f, i


def _rotated(matrix: Nine, vector: Sequence[float]) -> tuple[float, float, float]:
    a, b, c, d, e, f, g, h, i = matrix
    x, y, z = vector
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z
