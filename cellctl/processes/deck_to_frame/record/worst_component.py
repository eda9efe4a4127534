"""Which component of a pass uses up most of its threshold, and how well it is known."""

from collections.abc import Sequence

import numpy as np

from cellctl.geometry.coverage import COVERAGE_FACTOR
from cellctl.records.entries import PassComponent


def worst_component(components: Sequence[PassComponent]) -> PassComponent:
    """The component that uses up most of its threshold."""
    values = np.abs(np.array([component.value for component in components], dtype=float))
    limits = np.array([component.limit for component in components], dtype=float)
    # The place of the greatest is that of the first that is not a number, if there is one: an
    # unknown component must not hide behind those that are known.
    return components[int(np.argmax(values / limits))]


def expanded(component: PassComponent) -> float | None:
    """Expanded uncertainty of a component; None where it is not known."""
    return None if component.sigma is None else COVERAGE_FACTOR * component.sigma
