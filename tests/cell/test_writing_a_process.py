"""docs/writing-a-process.md is true: its package runs on the small fake cell, and a line PLC weighs
parts with it over Modbus; not one line of the core knows it.
"""

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.guides.package import ROOT, run
from tests.guides.weighing import GUIDE, SmallCell
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import Program


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


# `tests/programs` holds the guide's types and `cellctl check`; the same cell without it is started
# in `test_small_cell.py`.
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
def test_the_commands_of_the_page_weigh_a_part(
    small: SmallCell, installed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every command but those that install the package and copy the cell file, on ports of this
    test's own."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(installed), str(ROOT)]))
    monkeypatch.setenv("CELLCTL_SOCKET", str(small.store / "cellctl.sock"))
    monkeypatch.setenv("CELLCTL_DATA_DIR", str(small.store))
    own = {"acme.toml": str(small.file), "config/small.scenario.toml": str(small.scenario)}
    text = GUIDE.read_text(encoding="utf-8")
    lines = re.findall(r"^\.venv/bin/(?:python -m )?((?:cellctl|fakes) .*)$", text, re.MULTILINE)
    assert len(lines) == 6
    running: list[Program] = []
    try:
        for number, line in enumerate(lines):
            module, *words = (own.get(word, word) for word in line.split())
            if words[0] == "run":
                running.append(Program.start(tmp_path / str(number), module, *words))
                running[-1].ready()
                continue
            done = run(module, *words, path=(installed, ROOT))
            assert done.returncode == 0, done.stdout + done.stderr
        assert "B-1" in done.stdout
        assert "good" in done.stdout
    finally:
        for program in reversed(running):
            program.kill()


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
