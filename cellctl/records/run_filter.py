"""Which runs and alarms of a store somebody looks for."""

from dataclasses import dataclass
from datetime import UTC, datetime

OPEN = "open"
"""Result of a run that has not ended, which the store keeps as none."""


@dataclass(frozen=True, slots=True)
class RunFilter:
    """All conditions hold at once; what is None or empty is not asked."""

    before: int | None = None
    """Only runs with a lower number: the next page of a list."""
    serial: str = ""
    serial_begins: str = ""
    recipe: str = ""
    """Name of the recipe, whole."""
    operator: str = ""
    mode: str = ""
    """``PRODUCTION``, ``MAINTENANCE`` or ``DRY_RUN``."""
    result: str = ""
    """A ``RunResult``, or ``OPEN``."""
    fault: int | None = None
    """Number of a fault that ended the run, or of an alarm that it raised."""
    calibration: str = ""
    """Identity of a calibration that was used: the parts to recall when it turns out wrong."""
    since: datetime | None = None
    """Started then or later."""
    until: datetime | None = None
    """Started before."""

    def sql(self, each_of_json: str = "json_each") -> tuple[str, dict[str, object]]:
        """A condition on the rows of the table ``runs``, and the values that it names.

        ``each_of_json`` is the database's function that makes rows of a JSON object: that of
        SQLite, or ``json_each_text`` of PostgreSQL.
        """
        asked = {
            "number < :before": ("before", self.before),
            "serial = :serial": ("serial", self.serial),
            # Not LIKE: serial numbers may have % and _ in them, and case counts.
            "substr(serial, 1, length(:begins)) = :begins": ("begins", self.serial_begins),
            "recipe_name = :recipe": ("recipe", self.recipe),
            "operator = :operator": ("operator", self.operator),
            "mode = :mode": ("mode", self.mode),
            f"coalesce(result, '{OPEN}') = :result": ("result", self.result),
            "(fault_number = :fault OR EXISTS (SELECT 1 FROM alarms"
            " WHERE alarms.run = runs.number AND alarms.number = :fault))": ("fault", self.fault),
            f"EXISTS (SELECT 1 FROM {each_of_json}(runs.calibration_ids) AS used"
            " WHERE used.value = :calibration)": ("calibration", self.calibration),
            "started >= :since": ("since", _as_kept(self.since)),
            "started < :until": ("until", _as_kept(self.until)),
        }
        wanted = {text: named for text, named in asked.items() if named[1] not in (None, "")}
        return " AND ".join(wanted) or "TRUE", dict(wanted.values())


@dataclass(frozen=True, slots=True)
class AlarmFilter:
    """All conditions hold at once; what is None is not asked."""

    before: int | None = None
    """Only alarms with a lower id: the next page of a list."""
    active: bool | None = None
    """Whether nobody has acknowledged it."""
    number: int | None = None
    """Number of its fault."""
    run: int | None = None
    """Number of the run that it belongs to."""
    since: datetime | None = None
    """Came then or later."""
    until: datetime | None = None
    """Came before."""


def _as_kept(time: datetime | None) -> str | None:
    """As the store keeps a time: UTC, so that the order of the texts is that of the times."""
    return None if time is None else f"{time.astimezone(UTC):%Y-%m-%d %H:%M:%S.%f}"
