"""Files in the folder of calibrations that somebody has changed, renamed or kept for too long."""

import json
import shutil
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.store.envelope import read_stored
from cellctl.calibration.store.marker import mark_invalid
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.config import problems
from cellctl.config.commissioning import Examination, examine_before_commissioning
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, STEREO_HEAD_1
from tests.unit.config.test_mistakes import CONFIG, written


def examined(tmp_path: Path, change: Callable[[Path], object]) -> Examination:
    """The cell of decks with a change in a copy of its calibrations."""
    path = written(tmp_path / "cell", "deck.toml")
    place = path.parent / "demo-calibration"
    place.unlink()
    shutil.copytree(CONFIG / "demo-calibration", place)
    change(place)
    assert problems(path) == []  # the daemon starts, and refuses Start
    return examine_before_commissioning(path)


def exchanged(place: Path) -> None:
    (place / "head_1.json").rename(place / "other")
    (place / "head_2.json").rename(place / "head_1.json")
    (place / "other").rename(place / "head_2.json")


def edited(place: Path) -> None:
    path = place / "head_1.json"
    path.write_text(path.read_text().replace('"made": "2026', '"made": "2025'))


def record_alone(place: Path) -> None:
    path = place / "head_1.json"
    path.write_text(json.dumps(json.loads(path.read_text())["record"]))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (exchanged, "it holds head_2, so the file was renamed, copied or exchanged"),
        (lambda place: shutil.copy(place / "head_2.json", place / "head_1.json"), "holds head_2"),
        (edited, "content does not match its id; it was changed"),
        (lambda place: (place / "head_1.json").write_text('{"id": "1f'), "F631"),
        (record_alone, "'kind'"),
    ],
)
def test_a_file_that_the_daemon_refuses_is_an_error(
    tmp_path: Path, change: Callable[[Path], object], said: str
) -> None:
    errors = examined(tmp_path, change).errors
    found = [one for one in errors if one.value == "'demo-calibration/head_1.json'"]
    assert [(one.key, one.number) for one in found] == [("calibration_dir", 631)]
    assert found[0].line is not None
    assert said in f"F631 {found[0].allowed}"


def _stored_for(days: int) -> Callable[[Path], object]:
    def store(place: Path) -> None:
        stored = read_stored(place, "head_1")
        then = utc_now() + timedelta(days=days)
        folder = CalibrationStore(place, CALIBRATIONS, lambda: then)
        folder.store(STEREO_HEAD_1, stored.record, stored.serial_number, timedelta(days=1))

    return store


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_stored_for(-3), "expired on 20"),
        (_stored_for(3), "F636 Clock of the PC cannot be trusted"),
        (lambda place: mark_invalid(place, "head_1", "lens [1] touched", utc_now()), "lens [1]"),
    ],
)
def test_a_good_file_that_production_does_not_take_is_remarked(
    tmp_path: Path, change: Callable[[Path], object], said: str
) -> None:
    found = examined(tmp_path, change)
    assert found.errors == ()
    (remark,) = found.remarks
    assert (remark.key, remark.value) == ("calibration_dir", "'demo-calibration/head_1.json'")
    assert said in remark.allowed


def test_files_of_others_are_left_alone(tmp_path: Path) -> None:
    found = examined(tmp_path, lambda place: (place / "notes.json").write_text("no calibration"))
    assert (found.errors, found.remarks) == ((), ())
