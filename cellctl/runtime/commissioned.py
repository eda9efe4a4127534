"""What commissioning has measured about contact: it makes matings faster, never less careful.

A recipe states bounds that are safe without any measurement. A commissioned figure takes the place
of its bound while its record is there, passed and valid; otherwise the bound counts.
"""

from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from cellctl import log
from cellctl.calibration.files import StoredCalibration, read_calibration
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationMissing

_log = log.get(__name__)

STOP_LATENCY = "stop_latency"
CONTACT_STIFFNESS = "contact_stiffness"
"""Of each recipe's parts one, see ``stiffness_kind``."""


@dataclass(frozen=True, slots=True)
class Commissioned:
    """Upper bounds from measurements; None where the recipe's bound counts."""

    stop_latency_s: float | None = None
    stiffness_n_m: float | None = None
    """Arm and contact in series, as measured with one pair of parts."""
    records: tuple[StoredCalibration, ...] = ()
    """What they come from."""

    @property
    def ids(self) -> dict[str, str]:
        """Identity of each record by kind."""
        return {stored.kind: stored.id for stored in self.records}


def stiffness_kind(recipe_id: int) -> str:
    """Kind of the contact stiffness of one recipe's parts."""
    return f"{CONTACT_STIFFNESS}_{recipe_id}"


def read_commissioned(
    folder: Path, recipe_id: int, now: datetime, planned: timedelta
) -> Commissioned:
    """Figures whose records are valid now and stay so for ``planned``; stiffness of one recipe."""
    latency = _usable(folder, STOP_LATENCY, now, planned)
    stiffness = _usable(folder, stiffness_kind(recipe_id), now, planned)
    return Commissioned(
        stop_latency_s=latency.record["upper_ms"] / 1e3 if latency else None,
        stiffness_n_m=stiffness.record["upper_n_per_mm"] * 1e3 if stiffness else None,
        records=tuple(stored for stored in (latency, stiffness) if stored is not None),
    )


def _usable(folder: Path, kind: str, now: datetime, planned: timedelta) -> StoredCalibration | None:
    try:
        stored = read_calibration(folder, kind)
        stored.require_past(now)
    except CalibrationMissing:
        return None
    except CellError as error:
        _log.warning("commissioned figure not used", item=kind, reason=str(error))
        return None
    if not stored.passed or stored.valid_until <= now + planned:
        reason = "expired or about to" if stored.passed else "its verdict is not a pass"
        _log.warning("commissioned figure not used", item=kind, reason=reason)
        return None
    return stored
