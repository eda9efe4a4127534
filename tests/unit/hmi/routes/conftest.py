"""A store with what the routes are asked for: two parts, a calibration that turned out wrong."""

import shutil
from datetime import UTC, datetime
from pathlib import Path

import pytest

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.records.entries import Document
from cellctl.records.parts import MATE_SERIAL, PARTS
from cellctl.records.store import RunStore
from tests.unit.hmi.in_process import Api, settings_for
from tests.unit.records.conftest import start

MADE = datetime(2026, 1, 2, 3, 4, 5, 678000, tzinfo=UTC)


def head_calibration(residual: float, day: int) -> StoredCalibration:
    """A calibration of head 1, with the figure that it is judged by."""
    check = {
        "name": "residual",
        "value": residual,
        "limit": 0.2,
        "unit": "px",
        "side": "max",
        "passed": residual <= 0.2,
    }
    record = {"method": "test", "checks": [check]}
    made = MADE.replace(day=day)
    return StoredCalibration("head_1", record, made, made.replace(year=2036), "cellctl 1", "H-1")


OLD, NEW = head_calibration(0.12, 2), head_calibration(0.18, 3)


def fill(folder: Path) -> None:
    """Run 1 with the old calibration, run 2 joined to its part with the new one, run 3 open."""
    store = RunStore(folder)
    store.add_calibration(OLD)
    store.add_calibration(NEW)
    for serial, calibration in (("DECK-1", OLD), ("FRAME-1", NEW), ("DECK-2", NEW)):
        run = start(store, serial, calibrations={"head_1": calibration.id})
        if serial == "FRAME-1":
            store.add(run, Document(PARTS, {MATE_SERIAL: "DECK-1"}))
            store.add_alarm(run, 512, "F512 Force limit exceeded: Fz -50.8 N, limit 50.0")
        if serial != "DECK-2":
            store.close_run(run, "good")
    store.add_alarm(None, 207, "F207 first")
    store.add_alarm(None, 207, "F207 second")
    store.acknowledge_alarms(512, "page:anna@panel-1")
    store.invalidate_calibration(OLD, "the board was bent")
    store.audit(
        "page:anna@panel-1",
        "reset",
        {"mode": "production", "role": "operate", "key": "key-taken-1", "reason": "new shift"},
    )
    store.audit(
        "page:vera",
        "start",
        {"role": "view", "key": "key-refused-1", "reason": "", "refused": "not the role"},
    )
    store.close()


@pytest.fixture(scope="session")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store as it was closed; each test has a copy."""
    folder = tmp_path_factory.mktemp("store of the routes")
    fill(folder)
    return folder


@pytest.fixture
def store(filled: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(filled, tmp_path / "store"))


@pytest.fixture
async def api(store: Path) -> Api:
    api = Api(settings_for(store))
    await api.hear()
    return api
