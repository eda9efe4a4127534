"""From what the box sends to newtons: units E, C and M."""

from collections.abc import Callable, Sequence
from operator import mul

from drivers.ftsensor.sri.protocol import Six

Matrix = Sequence[Sequence[float]]
Conversion = Callable[[tuple[float, ...]], tuple[Six, bool]]
"""Six values of a point to the wrench and whether a converter was at its end."""

_FULL_SCALE = 65535
"""Greatest count of the 16 bit converter."""
_REFERENCE_MV = 5000.0
"""What the converter reads at full scale: x in mV/V is (count − AMPZ) / 65535 · 5000 mV / CHNAPG /
EXMV, as four public drivers compute it."""


def engineering(point: tuple[float, ...]) -> tuple[Six, bool]:
    """Unit E: the box has computed newtons and newton metres."""
    a, b, c, d, e, f = point
    return (a, b, c, d, e, f), False


def from_bridge(matrix: Matrix) -> Conversion:
    """Unit M: bridge signals in the unit that the matrix was made for."""

    def convert(point: tuple[float, ...]) -> tuple[Six, bool]:
        return _product(matrix, point), False

    return convert


def from_counts(
    matrix: Matrix, zero: Sequence[float], gain: Sequence[float], excitation_v: Sequence[float]
) -> Conversion:
    """Unit C: counts over zero, by amplifier gain and excitation (all ones for raw unit MV)."""
    scales = [
        _REFERENCE_MV / _FULL_SCALE / channel_gain / volts
        for channel_gain, volts in zip(gain, excitation_v, strict=True)
    ]
    # Gain, excitation and matrix are multiplied once here, and not for every sample.
    scaled = [[value * scale for value, scale in zip(row, scales, strict=True)] for row in matrix]
    offset = _product(scaled, zero)

    def convert(point: tuple[float, ...]) -> tuple[Six, bool]:
        a, b, c, d, e, f = _product(scaled, point)
        g, h, i, j, k, m = offset
        # A converter at its end reads a value that looks normal; only in counts can that be seen.
        at_end = min(point) <= 0 or max(point) >= _FULL_SCALE
        return (a - g, b - h, c - i, d - j, e - k, f - m), at_end

    return convert


def _product(matrix: Matrix, point: Sequence[float]) -> Six:
    a, b, c, d, e, f = (sum(map(mul, row, point)) for row in matrix)
    return a, b, c, d, e, f
