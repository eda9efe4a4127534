"""Recorded insertions whose sensor was not tared before the part touched anything.

Nothing is felt in free space. So the mean of what was recorded there is the zero, and one that is
off goes into everything that is judged after.
"""

from collections.abc import Iterable

import numpy as np

from cellctl.geometry.pose import Array

FEWEST_FREE = 20
"""Of fewer samples in free space nothing is said."""
_SIGMAS = 5.0
"""A mean that is off by less than so many of its standard deviations is noise."""

Allowed = tuple[str, str, float]
"""Name of a column, unit, and greatest mean that is none of a zero which matters."""


def zero_off(free: Array, columns: Iterable[Allowed], where: str) -> str | None:
    """Words for the first column whose mean in free space is off, with what is expected; else None.

    ``free`` (n, len(columns)) are the samples, in units of the columns; ``where`` says what they
    are, as "higher than 0.5 mm over the touch". A column that was not recorded is NaN.
    """
    if len(free) < FEWEST_FREE:
        return None
    mean, sigma = free.mean(axis=0), free.std(axis=0) / np.sqrt(len(free))
    for index, (name, unit, allowed) in enumerate(columns):
        most = max(allowed, _SIGMAS * float(sigma[index]))
        if abs(mean[index]) > most:
            return (
                f"{name} is {mean[index]:.3g} {unit} in the mean {where}, where nothing acts; "
                f"expected within {most:.2g} {unit} of 0: recorded without a tare, or a hose that "
                "pulls?"
            )
    return None
