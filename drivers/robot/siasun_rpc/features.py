"""What a controller can do, by the version that it names.

A server answers an unknown call with an exception of the service and passes over unknown arguments,
so versions are told apart by asking, and never by trying a motion.
"""

import re
from dataclasses import dataclass

from cellctl.errors.link import VersionMismatch
from cellctl.errors.robot import StreamNotOffered

Version = tuple[int, int, int]
OLDEST: Version = (3, 2, 0)
"""Core version of the manual that this driver follows (API V2.9)."""
SMOOTHED: Version = (3, 8, 4)
"""Core version from which streamed motion takes the figures of its smoothing."""


@dataclass(frozen=True, slots=True)
class ControllerFeatures:
    """What one controller can do."""

    version: str
    """As it names itself, empty when it does not know the call."""
    streams: bool
    """Whether its streamed motion is the one that this driver knows."""

    def not_offered(self, robot: str, period_ms: int | None) -> StreamNotOffered:
        """The fault of a stream that is asked for all the same."""
        version = self.version or "without a version"
        period = "no" if period_ms is None else "a"
        facts = f"{period} servo_period_ms in the cell file, controller software {version}"
        return StreamNotOffered(f"{robot}: {facts}")


def features(version: str | None) -> ControllerFeatures:
    """Read a version text; None for a controller that does not know the call for it.

    A controller without a readable version moves, but does not stream: how streamed motion behaves
    depends on arguments that came with a version. One that is too old is a ``VersionMismatch``.
    """
    found = re.search(r"(\d{1,3})\.(\d{1,3})(?:\.(\d{1,5}))?", version or "")
    if found is None:
        return ControllerFeatures(version or "", streams=False)
    major, minor, patch = (int(part or 0) for part in found.groups())
    if (major, minor, patch) < OLDEST:
        raise VersionMismatch(f"controller software {version}, at least 3.2.0 is needed")
    return ControllerFeatures(version or "", streams=(major, minor, patch) >= SMOOTHED)
