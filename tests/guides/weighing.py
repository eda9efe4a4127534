"""The package of docs/writing-a-process.md, and the small fake cell with its recipe."""

import re
from pathlib import Path

import pytest

from cellctl.records.entries import RunRecord
from cellctl.records.store import RunStore
from tests.guides.package import ROOT, guide_package
from tests.rigs.wire.ports import free_port

GUIDE = ROOT / "docs" / "writing-a-process.md"
_PORTS = re.compile(r"(?:\b\w*port|CMD|STA|GRD) = (\d{4})\b")


written, installed = guide_package(GUIDE, "cellctl-acme-weighing")


class SmallCell:
    """The small fake cell with the guide's recipe and ports of its own."""

    def __init__(self, folder: Path, recipe: str) -> None:
        self.ports: dict[int, int] = {}
        self.scenario, self.file = folder / "scenario.toml", folder / "cell.toml"
        self.store = folder / "store"
        config = ROOT / "config"
        self.scenario.write_text(self._own((config / "small.scenario.toml").read_text()))
        text = (config / "small.toml").read_text()
        folders = {"small-calibration": folder / "calibration", "runs/small": self.store}
        for old, new in folders.items():
            text = text.replace(f'"{old}"', f'"{new}"')
        # Nothing can be touched in this cell, and a busy machine must not decide about a part.
        text = text.replace("stale_ms = 300.0", "stale_ms = 500.0")
        text = text.replace("flange_age_ms = 300.0", "flange_age_ms = 1000.0")
        self.file.write_text(self._own(text) + "\n" + recipe)

    def _own(self, text: str) -> str:
        def own_port(match: re.Match[str]) -> str:
            port = self.ports.setdefault(int(match[1]), free_port(self.ports.values()))
            return match[0].replace(match[1], str(port))

        return _PORTS.sub(own_port, text)

    @property
    def modbus_port(self) -> int:
        return self.ports[5220]

    def run_record(self, number: int) -> RunRecord:
        store = RunStore(self.store, create=False)
        try:
            return store.run(number)
        finally:
            store.close()


@pytest.fixture
def small(written: Path, tmp_path: Path) -> SmallCell:
    return SmallCell(tmp_path, (written / "recipe.toml").read_text())
