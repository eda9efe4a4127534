"""The folder of calibrations: procedures store into it, production reads from it."""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from cellctl import log
from cellctl.calibration.store.calibration_io import raising_not_stored, write_file
from cellctl.calibration.store.envelope import (
    StoredCalibration,
    read_calibration,
    read_stored,
    require_clock_after,
    write_stored,
)
from cellctl.calibration.store.kind import CalibrationKind, Kinds, T, unparsed
from cellctl.calibration.store.marker import (
    SUFFIX,
    lift_invalidation,
    mark_invalid,
    require_not_invalidated,
)
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.validity import ValidityClock
from cellctl.clock import utc_now
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationExpired, CalibrationMissing
from cellctl.files.atomic_files import require_writable
from cellctl.version import software

_log = log.get(__name__)


class CalibrationStore:
    """Reads and writes the folder. All methods block on the disk, none of them for long."""

    def __init__(
        self,
        path: Path,
        kinds: Kinds,
        now: Callable[[], datetime] = utc_now,
    ) -> None:
        """``kinds``: all that the installed processes define.

        Raises ``ValueError`` when two kinds of one name differ.
        """
        self.path = path
        self.kinds = _by_name(kinds)
        self._now = now
        self._validity = ValidityClock(path, now)
        self.on_stored: list[Callable[[str], None]] = []
        """Called with the name of a calibration after it was made anew."""
        self.on_invalidated: list[Callable[[], None]] = []
        """Called before calibrations are invalidated, whichever they are."""

    def look_every(self, seconds: float) -> None:
        """Let ``validity_h``, ``least_h`` and ``all_valid`` rest on a look at the files so long."""
        self._validity.look_s = seconds

    def read(self, kind: CalibrationKind[T], until: datetime | None = None) -> T:
        """One result, valid until then; without ``until`` neither date nor verdict count.

        A procedure reads without ``until`` what it builds upon before the set is complete. Raises
        ``CalibrationMissing``, ``CalibrationInvalidated``, ``CalibrationRecordInvalid`` and
        with ``until`` also ``CalibrationExpired`` and ``ClockNotTrusted``.
        """
        if until is None:
            return kind.result(read_calibration(self.path, kind.name).record)
        return self.read_all([kind], until).get(kind)

    def read_all(self, kinds: Kinds, until: datetime) -> CalibrationSnapshot:
        """All results that are valid from now until then.

        A required kind that cannot be used raises ``CalibrationMissing``, ``CalibrationExpired``,
        ``CalibrationInvalidated``, ``CalibrationRecordInvalid`` or ``ClockNotTrusted``; the others
        are left out, with a warning when there is a file. A kind of each recipe must be that of
        one recipe (``for_recipe``); raises ``ValueError`` otherwise.
        """
        kinds = list(kinds)
        for kind in kinds:
            if kind.per_recipe:
                raise ValueError(f"{kind.name}: of which recipe?")
        stored, results = self._required([kind for kind in kinds if kind.required], until)
        for kind in kinds:
            if not kind.required:
                self._add_if_usable(kind, until, stored, results)
        return CalibrationSnapshot(results, stored)

    def store(
        self,
        kind: CalibrationKind[Any],
        record: Mapping[str, Any],
        serial_number: str,
        valid_for: timedelta,
        picture_png: bytes | None = None,
    ) -> StoredCalibration:
        """Put a record that passed into the folder in place of the one before.

        Raises ``CalibrationNotStored``.
        """
        now = self._now()
        # The id is that of the record as it will be read back: tuples have become lists.
        plain = json.loads(json.dumps(record))
        stored = StoredCalibration(
            kind.name, plain, now, now + valid_for, software(), serial_number
        )
        write_stored(self.path, stored)
        if picture_png is not None:
            write_file(self.path / f"{kind.name}.png", picture_png)
        # Only now: with the marker gone first, a crash would leave the old record valid.
        lift_invalidation(self.path, kind.name)
        self._validity.forget(kind.name)
        for tell in self.on_stored:
            tell(kind.name)
        return stored

    def invalidate(self, kinds: Kinds, reason: str) -> list[StoredCalibration]:
        """Mark what there is of these kinds as invalid until it is made anew; what it was.

        A kind of each recipe means the calibrations of all recipes. Raises
        ``CalibrationNotStored``.
        """
        names = self.names()
        return self._mark([name for kind in kinds for name in names if kind.includes(name)], reason)

    def refute(self, kind: CalibrationKind[Any], reason: str) -> StoredCalibration | None:
        """Mark one calibration as invalid whether it was ever made or not; what it was.

        For a measurement that contradicts what stands in for it: production starts neither with
        the earlier result nor with the bound of the recipe until a new one passes. Raises
        ``CalibrationNotStored``.
        """
        return next(iter(self._mark([kind.name], reason)), None)

    def require_not_invalidated(self, names: Iterable[str]) -> None:
        """Raise ``CalibrationInvalidated`` for the first of these that has been invalidated."""
        for name in names:
            require_not_invalidated(self.path, name)

    def put_aside(
        self, kind: CalibrationKind[Any], record: Mapping[str, Any], picture_png: bytes | None
    ) -> Path:
        """Keep a result that did not pass where nothing reads it; returns that folder.

        Raises ``CalibrationNotStored``.
        """
        folder = self.path / "rejected"
        text = json.dumps(record, indent=1) + "\n"
        write_file(folder / f"{kind.name}.json", text.encode())
        if picture_png is not None:
            write_file(folder / f"{kind.name}.png", picture_png)
        return folder

    def require_writable(self) -> None:
        """Raise ``CalibrationNotStored`` when no result could be stored here."""
        with raising_not_stored(self.path):
            require_writable(self.path)

    def fault(
        self, kinds: Kinds, planned: timedelta, newest: datetime | None = None
    ) -> CellError | None:
        """Why a run of the length ``planned`` may not start, or None.

        Asks for required kinds, and whether others were invalidated. ``newest`` is the newest time
        of all records: a clock that is behind it was set back.
        """
        now, kinds = self._now(), list(kinds)
        try:
            if newest is not None:
                require_clock_after(newest, now, "newest record")
            self.read_all([kind for kind in kinds if kind.required], now + planned)
            for kind in kinds:
                if kind.serves_production:
                    require_not_invalidated(self.path, kind.name)
        except CellError as error:
            return error
        return None

    def validity_h(self, kinds: Kinds) -> dict[str, float]:
        """Hours that are left, by register; 0 where a kind of the register is not valid.

        Reads a file again only when it has changed.
        """
        hours: dict[str, float] = {}
        for kind in kinds:
            if kind.register is not None:
                left_h = self._validity.hours(kind)
                hours[kind.register] = min(left_h, hours.get(kind.register, left_h))
        return hours

    def least_h(self, kinds: Kinds) -> float:
        """Hours until the first required kind ends; infinite where none is required; cheap.

        Kinds of each recipe do not count: nobody has chosen a recipe yet.
        """
        required = (kind for kind in kinds if kind.required and not kind.per_recipe)
        return min((self._validity.hours(kind) for kind in required), default=math.inf)

    def all_valid(self, kinds: Kinds, planned: timedelta = timedelta(0)) -> bool:
        """True when every required kind stays valid for longer than ``planned``, and none that
        production reads is invalidated; as ``least_h``.

        With a kind of each recipe, that of no recipe is invalidated.
        """
        kinds = list(kinds)
        names = self._validity.marked()
        invalidated = any(
            kind.serves_production and kind.includes(name) for kind in kinds for name in names
        )
        return not invalidated and self.least_h(kinds) > planned.total_seconds() / 3600

    def names(self) -> list[str]:
        """Names of all calibrations in the folder, sorted; also of those that are invalid."""
        stems = (file.stem for file in self.path.glob("*.json"))
        return sorted(name for name in stems if not name.endswith(SUFFIX))

    def named(self, name: str) -> CalibrationKind[Any]:
        """The kind of a calibration of this name; also of one that no installed process knows."""
        for kind in self.kinds:
            if name == kind.name:
                return kind
            if kind.includes(name):
                return kind.for_recipe(int(name.rpartition("_")[2]))
        return unparsed(name)

    def _mark(self, names: Iterable[str], reason: str) -> list[StoredCalibration]:
        """Mark calibrations as invalid; what there was of them."""
        for tell in self.on_invalidated:
            # Before the markers are written, so that nothing measured with a calibration is still
            # combined while that becomes invalid.
            tell()
        names = list(names)
        for name in names:
            mark_invalid(self.path, name, reason, self._now())
            self._validity.forget(name)
        return [one for name in names if (one := self._readable(name)) is not None]

    def _required(
        self, kinds: list[CalibrationKind[Any]], until: datetime
    ) -> tuple[dict[str, StoredCalibration], dict[str, Any]]:
        stored = {kind.name: read_calibration(self.path, kind.name) for kind in kinds}
        # All names at once: an operator wants to know everything that has to be done.
        rejected = [kind.name for kind in kinds if not kind.accepted(stored[kind.name].record)]
        if rejected:
            raise CalibrationMissing(f"not accepted: {', '.join(rejected)}")
        expired = [
            f"{name} ({one.valid_until:%Y-%m-%d})"
            for name, one in stored.items()
            if one.valid_until <= until
        ]
        if expired:
            raise CalibrationExpired(", ".join(expired))
        results = {kind.name: kind.result(stored[kind.name].record) for kind in kinds}
        for one in stored.values():
            one.require_past(self._now())
        return stored, results

    def _add_if_usable(
        self,
        kind: CalibrationKind[Any],
        until: datetime,
        stored: dict[str, StoredCalibration],
        results: dict[str, Any],
    ) -> None:
        if kind.name not in self.names():
            return  # never made: nothing to warn of
        try:
            found, result = self._required([kind], until)
        except CellError as error:
            _log.warning("calibration not used", item=kind.name, reason=str(error))
            return
        stored |= found
        results |= result

    def _readable(self, name: str) -> StoredCalibration | None:
        try:
            return read_stored(self.path, name)
        except CellError:
            return None  # it is marked; a file that nobody can read needs no row in the run store


def _by_name(kinds: Iterable[CalibrationKind[Any]]) -> tuple[CalibrationKind[Any], ...]:
    """Each kind once: two processes may share one, but not mean different things by its name."""
    known: dict[str, CalibrationKind[Any]] = {}
    for kind in kinds:
        if known.setdefault(kind.name, kind) != kind:
            raise ValueError(f"two processes define the calibration {kind.name!r} differently")
    return tuple(known.values())
