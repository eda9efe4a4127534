"""How long a load is watched until it counts as still."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Settling:
    """Seconds."""

    window_s: float = 0.4
    """Several periods of the swing of a heavy payload."""
    timeout_s: float = 8.0
    poll_s: float = 0.05
    reading_s: float = 0.5
    """Over which a force is averaged once the load is still, against noise."""


USUAL = Settling()
