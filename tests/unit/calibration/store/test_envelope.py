"""One file of the folder: what is written is what is read, and nothing that was changed."""

import hashlib
import json
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.calibration.solvers.base_frame.base_frame import BaseFrameResult
from cellctl.calibration.solvers.stereo.stereo import calibrate_stereo
from cellctl.calibration.solvers.stereo.stereo_result import StereoResult
from cellctl.calibration.solvers.transfer.board_transfer import TransferResult
from cellctl.calibration.store.envelope import StoredCalibration, read_calibration, write_stored
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.calibration.store.old_form import seal_old_files
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.errors.calibration import (
    CalibrationExpired,
    CalibrationMissing,
    CalibrationOfOldForm,
    CalibrationRecordInvalid,
)
from cellctl.processes.deck_to_frame.calibrations import (
    BASE_FRAME,
    BOARD_TRANSFER,
    CALIBRATIONS,
    STEREO_HEAD_1,
    STEREO_HEAD_2,
)
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.sealed_json import content_id
from tests.rigs.calibration import board_placements, turned_arm
from tests.rigs.calibration.stereo_views import BOARD, IMAGE_SIZE, make_views
from tests.unit.calibration.store.shipped import spoil

MADE = datetime(2026, 11, 21, 8, tzinfo=UTC)
UNTIL = MADE + timedelta(days=180)
GEOMETRY: tuple[CalibrationKind[Any], ...] = (
    STEREO_HEAD_1,
    STEREO_HEAD_2,
    BASE_FRAME,
    BOARD_TRANSFER,
)


def read_all(folder: Path, until: datetime = MADE) -> CalibrationSnapshot:
    return CalibrationStore(folder, CALIBRATIONS, lambda: MADE).read_all(GEOMETRY, until)


@pytest.fixture(scope="module")
def head() -> StereoResult:
    return calibrate_stereo(make_views(np.random.default_rng(0), 10), BOARD, IMAGE_SIZE)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, head: StereoResult) -> Path:
    folder = tmp_path_factory.mktemp("made")
    results: list[StereoResult | BaseFrameResult | TransferResult] = [
        head,
        head,
        turned_arm.calibrate(0),
        board_placements.calibrate(0),
    ]
    for kind, result in zip(GEOMETRY, results, strict=True):
        record, serial = result.to_record(), f"SN-{kind.name}"
        write_stored(folder, StoredCalibration(kind.name, record, MADE, UNTIL, "cellctl", serial))
    return folder


@pytest.fixture
def folder(tmp_path: Path, made: Path) -> Path:
    """A copy of what was solved once, for each test to spoil."""
    return Path(shutil.copytree(made, tmp_path / "calibrations"))


def test_what_is_written_is_what_production_reads(folder: Path, head: StereoResult) -> None:
    snapshot = read_all(folder)
    found = CalibrationSet.of(snapshot)
    first, second = found.heads
    np.testing.assert_allclose(first.translation_m, head.head.translation_m, rtol=1e-12)
    assert second.covariance is not None
    assert head.head.covariance is not None
    np.testing.assert_allclose(second.covariance, head.head.covariance, rtol=1e-9)
    transfer = board_placements.calibrate(0)
    np.testing.assert_allclose(
        found.c1_T_c2.pose.as_matrix(), transfer.c1_T_c2.pose.as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(found.base_T_c1.covariance, transfer.base_T_c1.covariance, rtol=1e-9)
    np.testing.assert_allclose(found.base_T_c2.covariance, transfer.base_T_c2.covariance, rtol=1e-9)
    assert found.c_T_base.sigma.shape == (6,)
    assert set(snapshot.ids) == {kind.name for kind in GEOMETRY}
    assert all(len(one) == 64 for one in snapshot.ids.values())


def test_envelope(folder: Path) -> None:
    stored = read_calibration(folder, "head_1")
    assert stored.made == MADE
    assert stored.valid_until == UNTIL
    assert stored.software == "cellctl"
    assert stored.serial_number == "SN-head_1"
    assert STEREO_HEAD_1.accepted(stored.record)
    assert not list(folder.glob(".*")), "no draft is left behind"


def test_same_result_has_the_same_identity(folder: Path) -> None:
    one = read_calibration(folder, "head_1")
    other = read_calibration(folder, "head_2")
    assert one.id == replace(other, kind="head_1", serial_number="SN-head_1").id
    assert one.id != other.id, "another instrument"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("valid_until", "2099-01-01T00:00:00+00:00"),
        ("made", "2026-11-21T09:00:00+00:00"),
        ("serial_number", "SN-of-another"),
        ("software", "cellctl 9"),
        ("kind", "head_2"),
        ("format", 3),
    ],
)
def test_no_field_can_be_edited(folder: Path, key: str, value: object) -> None:
    spoil(folder / "head_1.json", **{key: value})
    with pytest.raises(CalibrationRecordInvalid, match="head_1"):
        read_all(folder)


def test_a_field_that_nobody_knows_is_refused(folder: Path) -> None:
    spoil(folder / "head_1.json", certificate="none")
    with pytest.raises(CalibrationRecordInvalid, match="does not match its id"):
        read_all(folder)


def written_by_an_earlier_version(folder: Path, name: str) -> Path:
    """Its id was that of the record alone."""
    path = folder / f"{name}.json"
    data = json.loads(path.read_text())
    data.pop("format")
    canonical = json.dumps(data["record"], sort_keys=True, separators=(",", ":"))
    path.write_text(json.dumps(data | {"id": hashlib.sha256(canonical.encode()).hexdigest()}))
    return path


def test_a_file_of_an_earlier_version_is_refused_with_what_to_do(folder: Path) -> None:
    written_by_an_earlier_version(folder, "head_1")
    with pytest.raises(CalibrationOfOldForm, match="head_1") as refused:
        read_all(folder)
    assert "calibrate seal" in refused.value.remedy


def test_an_earlier_file_is_sealed_as_it_is(folder: Path, head: StereoResult) -> None:
    written_by_an_earlier_version(folder, "head_1")
    assert [one.kind for one in seal_old_files(folder)] == ["head_1"]
    stored = read_calibration(folder, "head_1")
    assert (stored.made, stored.valid_until) == (MADE, UNTIL)
    assert stored.serial_number == "SN-head_1"
    assert stored.record == json.loads(json.dumps(head.to_record()))
    assert seal_old_files(folder) == []


def test_an_earlier_file_that_was_changed_is_not_sealed(folder: Path) -> None:
    path = written_by_an_earlier_version(folder, "head_1")
    before = path.read_text()
    spoil(path, record={"verdict": "pass"})
    changed = path.read_text()
    assert changed != before
    with pytest.raises(CalibrationRecordInvalid, match="does not match its id"):
        seal_old_files(folder)
    assert path.read_text() == changed


def test_changed_file_is_refused(folder: Path) -> None:
    path = folder / "base_frame.json"
    data = json.loads(path.read_text())
    data["record"]["c_T_base"]["matrix_mm"][0][3] += 1e-6
    path.write_text(json.dumps(data))
    with pytest.raises(CalibrationRecordInvalid, match="does not match its id"):
        read_all(folder)


def test_file_under_another_name_is_refused(folder: Path) -> None:
    (folder / "board_transfer.json").write_text((folder / "base_frame.json").read_text())
    with pytest.raises(CalibrationRecordInvalid):
        read_all(folder)


@pytest.mark.parametrize("content", ["", "{}", "[1]", '{"kind": "head_1"'])
def test_damaged_file(folder: Path, content: str) -> None:
    (folder / "head_1.json").write_text(content)
    with pytest.raises(CalibrationRecordInvalid, match=r"head_1\.json"):
        read_all(folder)


def test_missing_file(folder: Path) -> None:
    (folder / "head_2.json").unlink()
    with pytest.raises(CalibrationMissing, match="head_2"):
        read_all(folder)


def test_expired(folder: Path) -> None:
    with pytest.raises(CalibrationExpired, match=r"head_1 \(2027-05-20\)"):
        read_all(folder, UNTIL)


@pytest.mark.parametrize(
    "changed", [{"made": "2026-11-21T08:00:00"}, {"valid_until": "2027-01-01"}, {"record": [1]}]
)
def test_a_time_without_zone_and_a_record_without_keys_are_refused(
    tmp_path: Path, changed: dict[str, Any]
) -> None:
    write_stored(tmp_path, StoredCalibration("kind", {}, MADE, UNTIL, "cellctl", ""))
    file = tmp_path / "kind.json"
    content = json.loads(file.read_text()) | changed
    del content["id"]
    file.write_text(json.dumps(content | {"id": content_id(content)}))
    with pytest.raises(CalibrationRecordInvalid):
        read_calibration(tmp_path, "kind")
