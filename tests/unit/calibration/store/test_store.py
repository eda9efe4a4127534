"""The folder of calibrations: what production gets, and what the line is told."""

import json
import math
import os
import stat
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from cellctl.calibration.store.envelope import read_calibration, write_stored
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.config import load_cell
from cellctl.errors import CellError
from cellctl.errors.calibration import (
    CalibrationExpired,
    CalibrationInvalidated,
    CalibrationMissing,
    CalibrationNotStored,
    CalibrationRecordInvalid,
    ClockNotTrusted,
    HeadPoseChanged,
)
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    CALIBRATIONS,
    CONTACT_STIFFNESS,
    PAYLOAD,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    STOP_LATENCY,
)
from cellctl.processes.deck_to_frame.record_names import HEAD_JOINTS
from tests.unit.calibration.store.shipped import CELL_FILE, REQUIRED, renew_calibrations, spoil

HOUR = timedelta(hours=1)


@pytest.fixture
def store(tmp_path: Path) -> CalibrationStore:
    folder = tmp_path / "calibration"
    renew_calibrations(folder)
    return CalibrationStore(folder, CALIBRATIONS)


def read_all(store: CalibrationStore, planned: timedelta = HOUR) -> CalibrationSnapshot:
    return store.read_all(REQUIRED, utc_now() + planned)


def fault(store: CalibrationStore, planned: timedelta = HOUR) -> CellError | None:
    return store.fault(CALIBRATIONS, planned)


def hours(store: CalibrationStore) -> dict[str, float]:
    return store.validity_h(CALIBRATIONS)


def test_all_of_them_are_read_with_their_identities(store: CalibrationStore) -> None:
    found = read_all(store)
    assert list(found.ids) == [kind.name for kind in REQUIRED]
    assert {one.kind for one in found.records} == set(found.ids)
    assert found.serial_numbers["head_2"] == "FH-0002"
    assert found.get(PAYLOAD).gravity_compensation.A.shape == (6, 3)
    assert fault(store) is None
    assert store.all_valid(CALIBRATIONS, HOUR)
    assert all(23 < left_h < 24.01 for left_h in hours(store).values())
    assert set(hours(store)) == {"stereo", "base_frame", "board_transfer", "payload"}


def test_the_first_to_end_is_the_least_of_the_required(store: CalibrationStore) -> None:
    assert 23 < store.least_h(CALIBRATIONS) < 24.01
    (store.path / f"{REQUIRED[0].name}.json").unlink()
    assert store.least_h(CALIBRATIONS) == 0.0
    assert store.least_h([]) == math.inf


@pytest.mark.parametrize("kind", [kind.name for kind in REQUIRED])
def test_each_of_them_is_needed(store: CalibrationStore, kind: str) -> None:
    assert store.all_valid(CALIBRATIONS)
    (store.path / f"{kind}.json").unlink()
    assert isinstance(fault(store), CalibrationMissing)
    assert not store.all_valid(CALIBRATIONS), "noticed although no other file has changed"


def test_one_that_expires_on_the_way_is_refused(store: CalibrationStore) -> None:
    renew_calibrations(store.path, timedelta(minutes=20))
    assert isinstance(fault(store, timedelta(minutes=30)), CalibrationExpired)
    assert fault(store, timedelta(minutes=10)) is None
    assert store.all_valid(CALIBRATIONS)
    assert not store.all_valid(CALIBRATIONS, timedelta(minutes=30))


def test_a_changed_record_is_refused(store: CalibrationStore) -> None:
    record = dict(read_calibration(store.path, "head_1").record)
    spoil(store.path / "head_1.json", record=record | {"rms_px": 0.001})
    assert isinstance(fault(store), CalibrationRecordInvalid)
    assert hours(store)["stereo"] == 0.0
    assert hours(store)["base_frame"] > 0.0


def test_a_payload_that_was_not_accepted_is_refused(store: CalibrationStore) -> None:
    record = dict(read_calibration(store.path, PAYLOAD.name).record) | {"accepted": False}
    store.store(PAYLOAD, record, "M4347K-1", HOUR)
    assert isinstance(fault(store, timedelta(0)), CalibrationMissing)


def test_another_instrument_does_not_get_the_calibration(store: CalibrationStore) -> None:
    found = read_all(store)
    found.require_instrument(STEREO_HEAD_1, "FH-0001")
    with pytest.raises(CalibrationRecordInvalid, match="FH-0009"):
        found.require_instrument(STEREO_HEAD_1, "FH-0009")


def test_a_head_that_was_taught_another_pose_is_refused(store: CalibrationStore) -> None:
    found = read_all(store)
    taught = load_cell(CELL_FILE).robots["aux_2"].poses_deg["measuring"]
    found.require_taught_pose(BOARD_TRANSFER, "head_2", taught)
    with pytest.raises(HeadPoseChanged, match=r"F637 .*head_2: made at \[-3\.29612"):
        found.require_taught_pose(BOARD_TRANSFER, "head_2", (taught[0] + 0.001, *taught[1:]))
    record = dict(read_calibration(store.path, "board_transfer").record)
    del record[HEAD_JOINTS]
    store.store(BOARD_TRANSFER, record, "ET-0001", 2 * HOUR)
    with pytest.raises(HeadPoseChanged, match="does not say"):
        read_all(store).require_taught_pose(BOARD_TRANSFER, "head_2", taught)


def test_a_stored_record_takes_effect_at_once(store: CalibrationStore) -> None:
    record = read_calibration(store.path, "head_1").record
    assert hours(store)["stereo"] > 2.0
    stored = store.store(STEREO_HEAD_1, record, "FH-0001", HOUR, b"picture")
    assert hours(store)["stereo"] == pytest.approx(1.0, abs=0.01)
    assert stored.software.startswith("cellctl ")
    assert read_all(store, timedelta(0)).ids["head_1"] == stored.id
    assert (store.path / "head_1.png").read_bytes() == b"picture"
    assert store.read(STEREO_HEAD_1).head.image_size == (2448, 2048)
    assert store.read(BASE_FRAME).c_T_base.covariance.shape == (6, 6)


def test_a_bad_result_is_kept_where_nothing_reads_it(store: CalibrationStore) -> None:
    before = read_all(store).ids
    folder = store.put_aside(STEREO_HEAD_1, {"verdict": "fail"}, b"picture")
    assert json.loads((folder / "head_1.json").read_text()) == {"verdict": "fail"}
    assert read_all(store).ids == before


def test_what_was_invalidated_stays_so_until_it_is_made_anew(store: CalibrationStore) -> None:
    assert store.all_valid(CALIBRATIONS)
    (old,) = store.invalidate([STEREO_HEAD_1], "F307 collision")
    assert old.kind == "head_1"
    store.invalidate([STEREO_HEAD_1], "something later")
    refused = fault(store)
    assert isinstance(refused, CalibrationInvalidated)
    assert "head_1: F307 collision" in refused.detail
    assert hours(store)["stereo"] == 0.0
    assert isinstance(fault(CalibrationStore(store.path, CALIBRATIONS)), CalibrationInvalidated)
    write_stored(store.path, old)
    assert isinstance(fault(store), CalibrationInvalidated), "an old file put back"
    with pytest.raises(CalibrationInvalidated):
        store.read(STEREO_HEAD_1)
    store.store(STEREO_HEAD_1, old.record, "FH-0001", 2 * HOUR)
    assert fault(store) is None


def test_a_marker_that_cannot_be_read_counts(store: CalibrationStore) -> None:
    (store.path / "payload.invalidated.json").write_text("{")
    assert isinstance(fault(store), CalibrationInvalidated)
    assert hours(store)["payload"] == 0.0


def test_stiffness_is_invalidated_for_every_recipe(store: CalibrationStore) -> None:
    for kind in (CONTACT_STIFFNESS.for_recipe(1), CONTACT_STIFFNESS.for_recipe(2)):
        store.store(kind, {"verdict": "pass"}, "", HOUR)
    found = store.invalidate([CONTACT_STIFFNESS, STOP_LATENCY], "F527")
    assert [one.kind for one in found] == ["contact_stiffness_1", "contact_stiffness_2"]
    assert store.fault([CONTACT_STIFFNESS.for_recipe(3)], HOUR) is None, "never made: bounds count"


def test_a_better_figure_that_somebody_declared_wrong_is_not_replaced_by_a_bound(
    store: CalibrationStore,
) -> None:
    stiffness = CONTACT_STIFFNESS.for_recipe(1)
    made = {"verdict": "pass"}
    store.store(stiffness, made, "", HOUR)
    assert store.all_valid([stiffness])
    store.invalidate([CONTACT_STIFFNESS], "fingers exchanged")
    refused = store.fault([stiffness], HOUR)
    assert isinstance(refused, CalibrationInvalidated)
    assert "fingers exchanged" in refused.detail
    assert not store.all_valid([stiffness]), "the line is told that no Start is taken"
    told = replace(stiffness, serves_production=False)
    assert store.fault([told], HOUR) is None
    assert store.all_valid([told])
    store.store(stiffness, made, "", HOUR)
    assert store.fault([stiffness], HOUR) is None


def test_the_line_learns_of_what_is_invalidated_of_any_recipe(store: CalibrationStore) -> None:
    stiffness = CONTACT_STIFFNESS.for_recipe(2)
    store.store(stiffness, {"verdict": "pass"}, "", HOUR)
    assert store.all_valid(store.kinds)
    store.invalidate([CONTACT_STIFFNESS], "F527")
    assert not store.all_valid(store.kinds), "kinds without a recipe, as the status asks"
    assert store.all_valid([CONTACT_STIFFNESS.for_recipe(1)]), "that of another part"
    told = replace(CONTACT_STIFFNESS, serves_production=False)
    assert store.all_valid([told])
    store.store(stiffness, {"verdict": "pass"}, "", HOUR)
    assert store.all_valid(store.kinds)


def test_a_clock_that_was_set_back_is_not_believed(store: CalibrationStore) -> None:
    assert store.fault(CALIBRATIONS, HOUR, utc_now()) is None
    later = utc_now() + timedelta(hours=1)
    assert isinstance(store.fault(CALIBRATIONS, HOUR, later), ClockNotTrusted)
    made = replace(read_calibration(store.path, "base_frame"), made=later)
    write_stored(store.path, made)
    refused = fault(store)
    assert isinstance(refused, ClockNotTrusted)
    assert "base_frame" in refused.detail
    assert hours(store)["base_frame"] == 0.0


def test_a_folder_that_cannot_be_written_is_a_numbered_fault(tmp_path: Path) -> None:
    (tmp_path / "calibration").write_text("a file, no folder")
    store = CalibrationStore(tmp_path / "calibration", CALIBRATIONS)
    for attempt in (
        store.require_writable,
        lambda: store.store(STEREO_HEAD_1, {}, "FH-0001", HOUR),
        lambda: store.put_aside(STEREO_HEAD_1, {}, None),
    ):
        with pytest.raises(CalibrationNotStored, match="F634"):
            attempt()


def test_the_probe_leaves_nothing(tmp_path: Path) -> None:
    CalibrationStore(tmp_path / "new" / "calibration", CALIBRATIONS).require_writable()
    assert list((tmp_path / "new" / "calibration").iterdir()) == []


def test_a_calibration_is_on_the_disk_before_it_has_its_name(
    store: CalibrationStore, monkeypatch: pytest.MonkeyPatch
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
    record = read_calibration(store.path, "head_1").record
    store.store(STEREO_HEAD_1, record, "FH-0001", HOUR)
    assert done == ["file", "name", "folder"]
    assert not list(store.path.glob("*.part"))


def test_a_kind_of_each_recipe_must_be_of_one(store: CalibrationStore) -> None:
    with pytest.raises(ValueError, match="of which recipe"):
        store.read_all([CONTACT_STIFFNESS], utc_now())


def test_one_name_means_one_kind(store: CalibrationStore) -> None:
    twice = CalibrationStore(store.path, (*CALIBRATIONS, *CALIBRATIONS))
    assert twice.kinds == CALIBRATIONS
    other = CalibrationKind(name="head_1", parse=dict)
    with pytest.raises(ValueError, match="head_1"):
        CalibrationStore(store.path, (*CALIBRATIONS, other))


def test_names_lead_to_kinds(store: CalibrationStore) -> None:
    assert store.named("head_2") is STEREO_HEAD_2
    assert store.named("contact_stiffness") is CONTACT_STIFFNESS
    assert store.named("contact_stiffness_12") == CONTACT_STIFFNESS.for_recipe(12)
    assert not store.named("something_else").required


def test_who_waits_is_told_of_what_changes(store: CalibrationStore) -> None:
    told = list[str]()
    store.on_stored.append(told.append)
    store.on_invalidated.append(lambda: told.append("invalidated"))
    store.store(STEREO_HEAD_1, read_calibration(store.path, "head_1").record, "FH-0001", HOUR)
    store.invalidate([STOP_LATENCY], "nothing was there")
    assert told == ["head_1", "invalidated"]


def test_one_result_with_a_date_must_be_valid_then(store: CalibrationStore) -> None:
    assert store.read(STEREO_HEAD_1, utc_now() + HOUR).head.image_size == (2448, 2048)
    with pytest.raises(CalibrationExpired, match="head_1"):
        store.read(STEREO_HEAD_1, utc_now() + timedelta(days=2))


def test_a_clock_that_is_right_again_is_believed_at_once(store: CalibrationStore) -> None:
    now = [utc_now() - timedelta(hours=2)]
    store = CalibrationStore(store.path, CALIBRATIONS, lambda: now[0])
    assert set(hours(store).values()) == {0.0}
    now[0] = utc_now()
    assert min(hours(store).values()) > 23
