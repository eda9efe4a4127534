"""From a raw reading to the contact wrench in the deck frame, in plain floats.

``w = T (raw − b − A u) − tare`` with u the unit vector of gravity in sensor axes and T the wrench
transport from sensor to deck. All but ``T raw`` changes only with the flange pose, fifty times a
second, so a sample costs 27 multiplications. The load on arrays is
``cellctl.force.compensation``. A deck that is pushed up by the frame has a positive Fz.
"""

from collections.abc import Sequence

from cellctl.guard.limits import Six

Nine = tuple[float, ...]
"""A 3x3 matrix row by row."""

ZERO: Six = (0.0,) * 6
_IDENTITY: Nine = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Compensator:
    """Holds the present deck frame, load, flange orientation and tare."""

    def __init__(self, flange_R_sensor: Nine = _IDENTITY) -> None:
        self.loaded = False
        """True once a load was set."""
        self._sensor_R_flange = _transposed(flange_R_sensor)
        self._load: list[Sequence[float]] = [(0.0, 0.0, 0.0)] * 6
        self._offset: Sequence[float] = ZERO
        self._base_down: Sequence[float] = (0.0, 0.0, -1.0)
        self._flange_R_base = _IDENTITY
        self._tare: Six = ZERO
        self._bias: Six = ZERO
        self.set_deck_frame(_IDENTITY, (0.0, 0.0, 0.0))

    @property
    def needs_pose(self) -> bool:
        """True when the load depends on the orientation of the flange."""
        return any(value != 0.0 for row in self._load for value in row)

    def set_load(
        self, load: Sequence[Sequence[float]], offset: Sequence[float], base_down: Sequence[float]
    ) -> None:
        """A (6x3, row by row), b (6) and the direction of gravity in the base; drops the tare."""
        self._load, self._offset, self._base_down = list(load), offset, base_down
        self.loaded = True
        self.set_tare(ZERO)

    def set_deck_frame(self, rotation: Nine, translation_m: Sequence[float]) -> None:
        """``sensor_T_deck``; drops the tare."""
        a, b, c, d, e, f, g, h, i = self._deck_R_sensor = _transposed(rotation)
        x, y, z = translation_m
        # torque about the deck's origin: R (m − t × f), so the force enters with −R [t]×
        self._torque_of_force = (
            (c * y - b * z, a * z - c * x, b * x - a * y),
            (f * y - e * z, d * z - f * x, e * x - d * y),
            (i * y - h * z, g * z - i * x, h * x - g * y),
        )
        self.set_tare(ZERO)

    def set_flange(self, rotation: Nine) -> None:
        """Rotation matrix of ``base_T_flange``."""
        self._flange_R_base = _transposed(rotation)
        self._update()

    def set_tare(self, tare: Six) -> None:
        """Deck-frame wrench that is zero from now on."""
        self._tare = tare
        self._update()

    def untared(self, wrench: Six) -> Six:
        """The same wrench before the tare."""
        a, b, c, d, e, f = (value + tare for value, tare in zip(wrench, self._tare, strict=True))
        return a, b, c, d, e, f

    def apply(self, raw: Six) -> Six:
        """The contact wrench of one raw reading."""
        fx, fy, fz, mx, my, mz = raw
        a, b, c, d, e, f, g, h, i = self._deck_R_sensor
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

    def _update(self) -> None:
        down = _rotated(self._sensor_R_flange, _rotated(self._flange_R_base, self._base_down))
        load = [
            row[0] * down[0] + row[1] * down[1] + row[2] * down[2] + offset
            for row, offset in zip(self._load, self._offset, strict=True)
        ]
        self._bias = ZERO
        fx, fy, fz, mx, my, mz = load
        transported = self.apply((fx, fy, fz, mx, my, mz))
        a, b, c, d, e, f = (
            value + tare for value, tare in zip(transported, self._tare, strict=True)
        )
        self._bias = (a, b, c, d, e, f)


def _transposed(matrix: Nine) -> Nine:
    a, b, c, d, e, f, g, h, i = matrix
    return a, d, g, b, e, h, c, f, i


def _rotated(matrix: Nine, vector: Sequence[float]) -> tuple[float, float, float]:
    a, b, c, d, e, f, g, h, i = matrix
    x, y, z = vector
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z
