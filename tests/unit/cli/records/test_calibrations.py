"""`cellctl calibrations`: history, figures and verdicts from the run store."""

import json
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from cellctl.calibration.store.envelope import read_stored
from cellctl.cli.records.calibrations import app
from cellctl.clock import utc_now
from cellctl.records import RunStore
from cellctl.records.procedure_entries import CALIBRATION_REJECTED

SHIPPED = Path(__file__).parents[4] / "config" / "demo-calibration"
RUNNER = CliRunner(env={"COLUMNS": "200", "NO_COLOR": "1"})


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


@pytest.fixture
def folder(store: RunStore) -> str:
    """Two years of one head, the second calibration void, and a payload."""
    head = read_stored(SHIPPED, "head_1")
    check = head.record["checks"][0]
    worse = {**check, "value": 7.0, "passed": False}
    record = {**head.record, "checks": [worse, *head.record["checks"][1:]]}
    newer = replace(head, made=head.made + timedelta(days=365), record=record)
    for stored in (head, newer, read_stored(SHIPPED, "payload")):
        store.add_calibration(stored)
    store.invalidate_calibration(newer, "collision")
    return str(store.path)


def asked(*words: str) -> Result:
    return RUNNER.invoke(app, list(words))


def test_the_newest_of_each_kind_is_listed(folder: str) -> None:
    done = asked("list", "--data-dir", folder)
    assert done.exit_code == 0, done.output
    (head,) = [line for line in done.stdout.splitlines() if line.startswith(" head_1")]
    assert "failed" in head
    assert "void since" in head
    assert "collision" in head
    assert "payload" in done.stdout


def test_brackets_in_a_reason_are_shown(store: RunStore, folder: str) -> None:
    store.invalidate_calibration(read_stored(SHIPPED, "payload"), "new [left] pad [/see 7]")
    done = asked("list", "--data-dir", folder)
    assert done.exit_code == 0, done.output
    assert "new [left] pad [/see 7]" in done.stdout


def test_a_kind_is_shown_with_its_figures_over_the_years(folder: str) -> None:
    done = asked("show", "head_1", "--data-dir", folder)
    assert done.exit_code == 0, done.output
    years = read_stored(SHIPPED, "head_1").made.year
    assert done.stdout.index(f"{years}-") < done.stdout.index(f"{years + 1}-"), "oldest first"
    (views,) = [line for line in done.stdout.splitlines() if line.strip().startswith("views")]
    assert views.split() == ["views", "24", "7", "beyond", "≥", "8"]


def test_programs_get_everything(folder: str) -> None:
    found = json.loads(asked("show", "head_1", "--json", "--data-dir", folder).stdout)
    assert [one["invalidated_reason"] for one in found] == [None, "collision"]
    assert found[0]["record"]["image_size"]
    listed = json.loads(asked("list", "--json", "--data-dir", folder).stdout)
    assert [one["kind"] for one in listed] == ["head_1", "payload"]


def test_what_is_not_there_is_said(store: RunStore) -> None:
    folder = str(store.path)
    assert "no calibrations" in asked("list", "--data-dir", folder).stdout
    done = asked("show", "head_9", "--data-dir", folder)
    assert done.exit_code == 1
    assert "head_9" in done.stderr
    assert "`cellctl status` lists them" in done.stderr


def test_a_rejected_result_is_told_until_one_of_its_kind_passes(
    store: RunStore, folder: str
) -> None:
    detail = {"item": "base_frame", "run": 7, "reason": "rms [x] 0.31, limit 0.2 px; kept in away"}
    store.audit("line", CALIBRATION_REJECTED, detail)
    for words in (("list",), ("show", "base_frame")):
        done = asked(*words, "--data-dir", folder)
        assert done.exit_code == 0, done.output
        assert "rejected, nothing uses it: base_frame" in done.stdout
        assert "run 7: rms [x] 0.31, limit 0.2 px; kept in away" in done.stdout
    head = read_stored(SHIPPED, "base_frame")
    store.add_calibration(replace(head, made=utc_now() + timedelta(seconds=1)))
    assert "rejected" not in asked("list", "--data-dir", folder).stdout
    assert "run 7" in asked("show", "base_frame", "--data-dir", folder).stdout


def test_names_are_whole_in_80_columns(store: RunStore, folder: str) -> None:
    stored = read_stored(SHIPPED, "contact_stiffness_1")
    store.add_calibration(stored)
    narrow = {"COLUMNS": "80", "NO_COLOR": "1"}
    done = CliRunner(env=narrow).invoke(app, ["list", "--data-dir", folder])
    assert " contact_stiffness_1 " in done.stdout
    assert stored.id[:12] in done.stdout
    assert "9999" not in done.stdout
    assert all(len(line) <= 80 for line in done.stdout.splitlines())
