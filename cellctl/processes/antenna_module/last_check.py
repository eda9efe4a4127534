"""When the reference was found in its place, while the daemon runs."""

from dataclasses import dataclass
from datetime import datetime, timedelta


@dataclass(slots=True)
class LastCheck:
    """Shared by all runs of one process."""

    passed: datetime | None = None
    """Start of the last run whose check was passed; None since the daemon started."""

    def due(self, now: datetime, taught: datetime, every: timedelta) -> bool:
        """Whether a run has to check; teaching the reference counts as a check of its own."""
        newest = taught if self.passed is None else max(self.passed, taught)
        # A clock that was set back must not put the next check off.
        return not timedelta(0) <= now - newest < every
