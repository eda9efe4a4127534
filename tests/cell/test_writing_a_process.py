"""docs/writing-a-process.md is true: its package is installed beside cellctl, runs on the small
fake cell, and a line PLC weighs parts with it over Modbus; not one line of the core knows it.
"""

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.records.entries import RunRecord
from cellctl.records.store import RunStore
from tests.guides.package import ROOT, install, run, write_files
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import Program, free_port

GUIDE = ROOT / "docs" / "writing-a-process.md"
MOST_LINES = 200
_PORTS = re.compile(r"(?:\b\w*port|CMD|STA|GRD) = (\d{4})\b")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("cellctl-acme-weighing")
    write_files(GUIDE, folder)
    return folder


@pytest.fixture(scope="module")
def installed(written: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    site = tmp_path_factory.mktemp("site")
    install(written, site)
    return site


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
            port = self.ports.setdefault(int(match[1]), free_port())
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


@pytest.fixture
def plc(
    small: SmallCell, installed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[OutsidePlc]:
    """Fake cell and daemon are up, with the guide's package on their path; Idle."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(installed), str(ROOT)]))
    options = ["--scenario", str(small.scenario), "--seed", "1"]
    fake = Program.start(tmp_path / "fake", "fakes", "run", *options)
    daemon: Program | None = None
    try:
        fake.ready()
        daemon = Program.start(tmp_path / "daemon", "cellctl", "run", str(small.file))
        daemon.ready()
        with OutsidePlc(small.modbus_port) as plc:
            plc.start_heartbeat()
            assert plc.command("Reset", mode=1) == 0
            assert plc.done(60.0).startswith("done")
            yield plc
    finally:
        for program in (daemon, fake):
            if program is not None:
                program.kill()


def test_the_package_is_short(written: Path) -> None:
    code = "\n".join(path.read_text() for path in (written / "acme_weighing").glob("*.py"))
    assert sum(bool(line.strip()) for line in code.splitlines()) < MOST_LINES


def test_its_types_hold(written: Path) -> None:
    done = run("mypy", "--strict", str(written / "acme_weighing"), path=(written, ROOT))
    assert done.returncode == 0, done.stdout


def test_check_knows_what_it_needs(small: SmallCell, installed: Path) -> None:
    done = run("cellctl", "check", str(small.file), path=(installed, ROOT))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "bracket (acme-weighing): this cell can run it" in done.stdout
    text = small.file.read_text()
    small.file.write_text(text.replace("[cameras.camera]", "[cameras.other]"))
    done = run("cellctl", "check", str(small.file), path=(installed, ROOT))
    assert done.returncode == 1
    assert "the cell lacks [cameras.camera]: looks at the plate" in done.stdout


def test_its_fault_is_told_with_its_remedy(installed: Path) -> None:
    done = run("cellctl", "faults", "1001", path=(installed, ROOT))
    assert done.returncode == 0, done.stderr
    assert "weigh the part on a scale" in done.stdout
    assert "stop" in done.stdout


def test_without_the_package_the_recipe_is_refused(small: SmallCell) -> None:
    done = run("cellctl", "check", str(small.file), path=(ROOT,))
    assert done.returncode == 1
    assert "recipes.0.process" in done.stdout


# The standard tests hold the guide's types and `cellctl check`, and start the same cell without it.
@pytest.mark.long
def test_a_part_is_weighed_over_modbus(
    small: SmallCell, plc: OutsidePlc, installed: Path, tmp_path: Path
) -> None:
    assert plc.command("Start", mode=1, recipe=1, serial="B-1") == 0
    assert plc.done(120.0).startswith("done")
    record = small.run_record(1)
    assert (record.head.process, record.head.serial) == ("acme-weighing", "B-1")
    figures = {figure.key: figure for figure in record.figures}
    assert figures["mass"].value == pytest.approx(5.0, abs=0.2)
    assert [phase.label for phase in record.phases] == ["tare", "look", "weigh"]
    assert [artefact.name for artefact in record.artefacts if "look" in artefact.name]
    out = tmp_path / "report"
    options = ["--data-dir", str(small.store), "--out", str(out)]
    done = run("cellctl", "runs", "export", "1", *options, path=(installed, ROOT))
    assert done.returncode == 0, done.stderr
    page = (out / "report.html").read_text()
    assert "Mass" in page
    assert "B-1" in page
    shutil.rmtree(out)
    done = run("cellctl", "runs", "export", "1", *options, path=(ROOT,))
    assert done.returncode == 0, "a run of a process that is no longer installed"


@pytest.mark.long
def test_a_part_of_the_wrong_weight_is_bad(
    written: Path, installed: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    small: SmallCell = request.getfixturevalue("small")
    small.file.write_text(small.file.read_text().replace("expected_kg = 5.0", "expected_kg = 4.0"))
    plc: OutsidePlc = request.getfixturevalue("plc")
    assert plc.command("Start", mode=1, recipe=1, serial="B-2") == 0
    plc.done(120.0)
    assert plc.value("first_out_alarm") == 1001
    record = small.run_record(1)
    assert record.head.result == "bad"
    assert record.head.fault_number == 1001
    out = tmp_path / "report"
    options = ["--data-dir", str(small.store), "--out", str(out)]
    done = run("cellctl", "runs", "export", "1", *options, path=(installed, ROOT))
    assert done.returncode == 0, done.stderr
    assert "weigh the part on a scale" in (out / "report.html").read_text()
