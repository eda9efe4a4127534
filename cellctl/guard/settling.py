"""How long a load is watched until it counts as still (docs/decisions/0005)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Settling:
    """The times of one judgement that a load hangs still."""

    window_s: float = 0.4
    """The wrench has to be steady for so long: four periods of 200 kg on a compliant arm, which
    swing at about 11 Hz."""
    timeout_s: float = 8.0
    """A load that is not still by then is a fault: a soft gripper, or a hose that swings."""
    poll_s: float = 0.05
    """Pause between two looks at the newest window: an eighth of it, so that rest is noticed
    soon."""
    reading_s: float = 0.5
    """Once the load is still, a force is averaged over this time: the mean of 500 samples at 1 kHz
    has a twentieth of the noise of one."""


USUAL = Settling()
"""Settling of the loads that docs/decisions/0005 was measured with, up to 200 kg."""
