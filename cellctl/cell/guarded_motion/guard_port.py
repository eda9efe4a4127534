"""The part of the guard's client that motions in contact use, as an interface."""

from typing import Protocol

from scipy.spatial.transform import RigidTransform

from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import GuardLimits
from cellctl.guard.report import GuardSample, GuardSamples, GuardTrip, TareResult


class GuardPort(Protocol):
    """The guard as a contact sees it; ``cellctl.guard.client.GuardClient`` in the cell."""

    @property
    def trip(self) -> GuardTrip | None:
        """The latched trip, or None."""
        ...

    def latest(self) -> GuardSample:
        """The newest sample."""
        ...

    def samples(self, since_s: float) -> GuardSamples:
        """All samples later than a time."""
        ...

    def health(self) -> GuardHealth:
        """How the guard is doing; never raises."""
        ...

    async def set_wrench_frame(self, sensor_T_wrench: RigidTransform | None) -> None:
        """Give wrenches in this frame from now on, None the sensor's own; drops the tare."""
        ...

    async def tare(self, duration_s: float) -> TareResult:
        """Average so long and take that as zero."""
        ...

    async def arm(self, limits: GuardLimits) -> None:
        """Watch these limits from now on."""
        ...

    async def disarm(self) -> None:
        """Watch no force limits."""
        ...

    async def acknowledge(self) -> None:
        """Release a latched trip."""
        ...
