"""Hours for which calibrations stay valid, cheap enough for every update of the PLC."""

import math
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.calibration.store.marker import marked, marker
from cellctl.clock import Monotonic, now_s
from cellctl.errors import CellError

LOOK_S = 0.5
"""How often a daemon looks at the files, for what it shows ten times a second: looks at each moment
are four fifths of what such a snapshot costs its event loop. Who starts a run reads the files."""
Stamp = tuple[tuple[int, int], ...]
"""Time of change and size of a calibration's files: changes when one changes, goes or appears."""
_MARKERS = ""
"""Stands for all markers together; no calibration is called so."""


class ValidityClock:
    """Reads a calibration again only when its file or its marker has changed.

    What this process changes itself is seen at once (``forget``), another's work after ``look_s``.
    """

    def __init__(
        self,
        folder: Path,
        now: Callable[[], datetime],
        look_s: float = 0.0,
        clock: Monotonic = now_s,
    ) -> None:
        self._folder = folder
        self._now = now
        self.look_s = look_s
        self._clock = clock
        self._known: dict[str, tuple[Stamp, StoredCalibration | None]] = {}
        self._marked: list[str] = []
        self._looked_s: dict[str, float] = {}
        """When the files of a calibration were looked at last, and the markers by ``_MARKERS``."""

    def hours(self, kind: CalibrationKind[Any]) -> float:
        """Hours that are left; 0 when the calibration may not be used. Never raises."""
        stored = self._usable(kind)
        now = self._now()
        try:
            if stored is None:
                return 0.0
            stored.require_past(now)
        except CellError:
            return 0.0  # the line learns "not valid"; who starts production gets the fault itself
        return max(0.0, (stored.valid_until - now).total_seconds() / 3600)

    def forget(self, name: str) -> None:
        """Read this calibration again next time, although its files may look the same."""
        # Two writes within the resolution of the file system's clock have the same stamp.
        self._known.pop(name, None)
        self._looked_s.clear()

    def marked(self) -> list[str]:
        """Names of all calibrations that were invalidated, sorted. Never raises."""
        if self._is_due(_MARKERS):
            self._marked = marked(self._folder)
        return self._marked

    def _is_due(self, name: str) -> bool:
        time_s = self._clock()
        if time_s - self._looked_s.get(name, -math.inf) < self.look_s:
            return False
        self._looked_s[name] = time_s
        return True

    def _usable(self, kind: CalibrationKind[Any]) -> StoredCalibration | None:
        known = self._known.get(kind.name)
        due = self._is_due(kind.name)
        if known is not None and not due:
            return known[1]
        files = (self._folder / f"{kind.name}.json", marker(self._folder, kind.name))
        # Taken before the file is read: a change in between is then found the next time.
        stamp = tuple(_changed(file) for file in files)
        if known is None or known[0] != stamp:
            known = self._known[kind.name] = stamp, self._read(kind)
        return known[1]

    def _read(self, kind: CalibrationKind[Any]) -> StoredCalibration | None:
        try:
            stored = read_calibration(self._folder, kind.name)
        except CellError:
            return None
        return stored if kind.accepted(stored.record) else None


def _changed(path: Path) -> tuple[int, int]:
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
