"""What procedures of a demonstration have stored: figures, limits, verdicts, and where it lies."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.table import Table

_DIGITS = 4


class StoredResults:
    """The calibrations in a folder; tells the new ones each time."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._seen = dict(self._files())

    def new(self) -> Iterator[Table]:
        """A table for each calibration that was stored since this was last asked."""
        files = dict(self._files())
        changed = [path for path, content in files.items() if self._seen.get(path) != content]
        self._seen = files
        return (_table(path, json.loads(files[path])["record"]) for path in changed)

    def _files(self) -> Iterator[tuple[Path, bytes]]:
        for path in sorted(self._folder.glob("*.json")):
            if not path.name.endswith(".invalidated.json"):
                yield path, path.read_bytes()


def _table(path: Path, record: dict[str, Any]) -> Table:
    table = Table("figure", "value", "limit", "verdict", title=path.stem, caption=str(path))
    for check in record["checks"]:
        unit = f" {check['unit']}" if check["unit"] else ""
        relation = "≥" if check.get("side") == "min" else "≤"
        table.add_row(
            check["name"],
            f"{check['value']:.{_DIGITS}g}{unit}",
            f"{relation} {check['limit']:.{_DIGITS}g}{unit}",
            "within" if check["passed"] else "beyond",
            style=None if check["passed"] else "red",
        )
    return table
