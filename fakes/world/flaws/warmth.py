"""What warmth does to an arm after it was calibrated: links grow, joints shift."""

from dataclasses import replace

import numpy as np

from fakes.world.arm import Links

_GROWTH_PER_K = 20e-6
"""Relative growth of a link: between that of steel (12e-6) and of aluminium (23e-6)."""
_JOINT_RAD_PER_K = 2e-6
"""Shift of a joint's zero; assumed."""


def warmed(links: Links, rng: np.random.Generator, kelvin: float) -> Links:
    """The same arm with every link at a temperature of its own; ``kelvin``: their spread."""
    warmth_k = rng.normal(0.0, kelvin, len(links.matrices))
    matrices = links.matrices.copy()
    matrices[:, :3, 3] *= (1 + _GROWTH_PER_K * warmth_k)[:, None]
    offsets = links.joint_offsets_rad + _JOINT_RAD_PER_K * rng.normal(0.0, kelvin, 6)
    return replace(links, matrices=matrices, joint_offsets_rad=offsets)
