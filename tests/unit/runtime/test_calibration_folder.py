"""The folder of calibrations: what production gets, and what the line is told."""

import json
import os
import stat
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.files import read_calibration, write_stored
from cellctl.clock import utc_now
from cellctl.errors.calibration import (
    CalibrationExpired,
    CalibrationInvalidated,
    CalibrationMissing,
    CalibrationNotStored,
    CalibrationRecordInvalid,
    ClockNotTrusted,
    HeadPoseChanged,
)
from cellctl.runtime.calibration_folder import (
    ALL_KINDS,
    HEAD_JOINTS,
    PAYLOAD,
    CalibrationFolder,
)
from tests.unit.cell.bench import Bench, renew_calibrations, spoil

HOUR = timedelta(hours=1)


def test_all_of_them_are_read_with_their_identities(bench: Bench) -> None:
    found = bench.calibrations.read(HOUR)
    assert set(found.ids) == set(ALL_KINDS)
    assert found.serial_numbers["head_2"] == "FH-0002"
    assert found.gravity_compensation.A.shape == (6, 3)
    assert bench.calibrations.fault(HOUR) is None
    assert bench.calibrations.all_valid(HOUR)
    assert all(23 < hours < 24.01 for hours in bench.calibrations.validity_h())


@pytest.mark.parametrize("kind", ALL_KINDS)
def test_each_of_them_is_needed(bench: Bench, kind: str) -> None:
    assert bench.calibrations.all_valid()
    (bench.calibrations.path / f"{kind}.json").unlink()
    assert isinstance(bench.calibrations.fault(HOUR), CalibrationMissing)
    assert not bench.calibrations.all_valid(), "noticed although no other file has changed"


def test_one_that_expires_on_the_way_is_refused(bench: Bench) -> None:
    renew_calibrations(bench.calibrations.path, timedelta(minutes=20))
    assert isinstance(bench.calibrations.fault(timedelta(minutes=30)), CalibrationExpired)
    assert bench.calibrations.fault(timedelta(minutes=10)) is None
    assert bench.calibrations.all_valid()
    assert not bench.calibrations.all_valid(timedelta(minutes=30))


def test_a_changed_record_is_refused(bench: Bench) -> None:
    folder = bench.calibrations
    record = dict(read_calibration(folder.path, "head_1").record)
    spoil(folder.path / "head_1.json", record=record | {"rms_px": 0.001})
    assert isinstance(folder.fault(HOUR), CalibrationRecordInvalid)
    assert folder.validity_h()[0] == 0.0
    assert folder.validity_h()[1] > 0.0


def test_a_payload_that_was_not_accepted_is_refused(bench: Bench) -> None:
    folder = bench.calibrations
    record = dict(read_calibration(folder.path, PAYLOAD).record) | {"accepted": False}
    folder.store(PAYLOAD, record, "M4347K-1", HOUR)
    assert isinstance(folder.fault(timedelta(0)), CalibrationMissing)


def test_another_instrument_does_not_get_the_calibration(bench: Bench) -> None:
    found = bench.calibrations.read(HOUR)
    found.require_instrument("head_1", "FH-0001")
    with pytest.raises(CalibrationRecordInvalid, match="FH-0009"):
        found.require_instrument("head_1", "FH-0009")


def test_a_head_that_was_taught_another_pose_is_refused(bench: Bench) -> None:
    folder = bench.calibrations
    taught = bench.cell.config.robots["aux_2"].poses_deg["measuring"]
    found = folder.read(HOUR)
    found.require_head_pose("head_2", taught)
    with pytest.raises(HeadPoseChanged, match=r"F637 .*head_2: made at \[-3\.29612"):
        found.require_head_pose("head_2", (taught[0] + 0.001, *taught[1:]))
    record = dict(read_calibration(folder.path, "board_transfer").record)
    del record[HEAD_JOINTS]
    folder.store("board_transfer", record, "ET-0001", 2 * HOUR)
    with pytest.raises(HeadPoseChanged, match="does not say"):
        folder.read(HOUR).require_head_pose("head_2", taught)


def test_a_stored_record_takes_effect_at_once(bench: Bench) -> None:
    folder = bench.calibrations
    record = read_calibration(folder.path, "head_1").record
    told: list[str] = []
    folder.on_stored.append(told.append)
    assert folder.validity_h()[0] > 2.0
    stored = folder.store("head_1", record, "FH-0001", HOUR, b"picture")
    assert folder.validity_h()[0] == pytest.approx(1.0, abs=0.01)
    assert folder.read(timedelta(0)).ids["head_1"] == stored.id
    assert (folder.path / "head_1.png").read_bytes() == b"picture"
    assert told == ["head_1"]
    assert folder.head("head_1").image_size == (2448, 2048)
    assert folder.c_T_base().covariance.shape == (6, 6)
    assert {one.kind for one in folder.stored()} == set(ALL_KINDS)


def test_a_bad_result_is_kept_where_nothing_reads_it(bench: Bench) -> None:
    before = bench.calibrations.read(HOUR).ids
    folder = bench.calibrations.put_aside("head_1", {"verdict": "fail"}, b"picture")
    assert json.loads((folder / "head_1.json").read_text()) == {"verdict": "fail"}
    assert bench.calibrations.read(HOUR).ids == before


def test_what_was_invalidated_stays_so_until_it_is_made_anew(bench: Bench) -> None:
    folder = bench.calibrations
    assert folder.all_valid()
    (old,) = folder.invalidate(["head_1"], "F307 collision")
    assert old.kind == "head_1"
    folder.invalidate(["head_1"], "something later")
    fault = folder.fault(HOUR)
    assert isinstance(fault, CalibrationInvalidated)
    assert "head_1: F307 collision" in fault.detail
    assert folder.validity_h()[0] == 0.0
    assert isinstance(CalibrationFolder(folder.path).fault(HOUR), CalibrationInvalidated)
    write_stored(folder.path, old)
    assert isinstance(folder.fault(HOUR), CalibrationInvalidated), "an old file put back"
    with pytest.raises(CalibrationInvalidated):
        folder.head("head_1")
    folder.store("head_1", old.record, "FH-0001", 2 * HOUR)
    assert folder.fault(HOUR) is None


def test_a_marker_that_cannot_be_read_counts(bench: Bench) -> None:
    (bench.calibrations.path / "payload.invalidated.json").write_text("{")
    assert isinstance(bench.calibrations.fault(HOUR), CalibrationInvalidated)
    assert bench.calibrations.validity_h()[3] == 0.0


def test_stiffness_is_invalidated_for_every_recipe_and_observers_are_told(bench: Bench) -> None:
    folder = bench.calibrations
    told: list[bool] = []
    folder.on_invalidated.append(lambda: told.append(True))
    for kind in ("contact_stiffness_1", "contact_stiffness_2"):
        folder.store(kind, {"verdict": "pass"}, "", HOUR)
    found = folder.invalidate(["contact_stiffness", "stop_latency"], "F527")
    assert [one.kind for one in found] == ["contact_stiffness_1", "contact_stiffness_2"]
    assert told == [True]
    assert folder.fault(timedelta(0)) is None, "production does without it"


def test_a_clock_that_was_set_back_is_not_believed(bench: Bench) -> None:
    folder = bench.calibrations
    assert folder.fault(HOUR, utc_now()) is None
    later = utc_now() + timedelta(hours=1)
    assert isinstance(folder.fault(HOUR, later), ClockNotTrusted)
    made = replace(read_calibration(folder.path, "base_frame"), made=later)
    write_stored(folder.path, made)
    fault = folder.fault(HOUR)
    assert isinstance(fault, ClockNotTrusted)
    assert "base_frame" in fault.detail
    assert folder.validity_h()[1] == 0.0


def test_a_folder_that_cannot_be_written_is_a_numbered_fault(tmp_path: Path) -> None:
    (tmp_path / "calibration").write_text("a file, no folder")
    folder = CalibrationFolder(tmp_path / "calibration")
    for attempt in (
        folder.require_writable,
        lambda: folder.store("head_1", {}, "FH-0001", HOUR),
        lambda: folder.put_aside("head_1", {}, None),
    ):
        with pytest.raises(CalibrationNotStored, match="F634"):
            attempt()


def test_the_probe_leaves_nothing(tmp_path: Path) -> None:
    CalibrationFolder(tmp_path / "new" / "calibration").require_writable()
    assert list((tmp_path / "new" / "calibration").iterdir()) == []


def test_a_calibration_is_on_the_disk_before_it_has_its_name(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bytes, then name, then the folder's entry."""
    done: list[str] = []
    fsync, replace = os.fsync, Path.replace

    def synced(descriptor: int) -> None:
        done.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        fsync(descriptor)

    def named(draft: Path, target: Path) -> Path:
        done.append("name")
        return replace(draft, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "replace", named)
    record = read_calibration(bench.calibrations.path, "head_1").record
    bench.calibrations.store("head_1", record, "FH-0001", HOUR)
    assert done == ["file", "name", "folder"]
    assert not list(bench.calibrations.path.glob("*.part"))
