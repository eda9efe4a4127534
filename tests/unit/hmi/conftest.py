"""The page's process before a daemon made of paper and a store with two runs."""

import hashlib
import shutil
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.hmi.visitors.people import secret_of
from cellctl.records.figures import Limit, figure
from cellctl.records.store import RunStore
from tests.unit.hmi.http_client import Client
from tests.unit.hmi.scripted_daemon import PIN, PaperDaemon, page_thread, serving

TOKEN = "a-token-of-a-program"


def _store(folder: Path) -> None:
    store = RunStore(folder)
    opening: dict[str, Any] = {
        "process": "deck-to-frame",
        "recipe_id": 1,
        "recipe_name": "a part",
        "recipe_hash": "0" * 64,
        "mode": "production",
        "software": "test",
        "config_hash": "1" * 64,
        "simulated": True,
    }
    for serial, result in (("SAT-1", "good"), ("SAT-2", "aborted")):
        number = store.start_run(serial=serial, calibration_ids={"head": f"id-{serial}"}, **opening)
        store.begin_phase(number, 10, "measure")
        store.add(
            number, figure("peak", 41.5, "N", label="greatest force", limit=Limit(upper=50.0))
        )
        store.add_artefact(number, "look.png", b"\x89PNG of " + serial.encode(), "image/png")
        store.add_artefact(number, "page.html", b"<script>1</script>", "text/html")
        store.add_alarm(number, 512, "F512 Force limit exceeded: Fz -50.8 N, limit 50.0")
        store.close_run(number, result)
    store.acknowledge_alarms(512, "page:anna@panel-1")
    store.add_alarm(None, 207, "F207 Data from a device is too old: head 1")
    for year, residual in ((2025, 0.12), (2026, 0.21)):
        made = datetime(year, 1, 2, 3, 4, 5, tzinfo=UTC)
        check = {"name": "residual", "value": residual, "limit": 0.2, "unit": "px", "side": "max"}
        record = {"checks": [check | {"passed": residual <= 0.2}]}
        until = made.replace(year=2036)
        store.add_calibration(StoredCalibration("head", record, made, until, "test", "H-1"))
    asked = {"mode": "maintenance", "recipe": 101, "serial": ""}
    store.audit("page:anna", "start", asked)
    store.audit("page:anna", "procedure ended", {"procedure": "calibrate head 1"})
    store.audit("page:anna", "set", {"acknowledged": 512})
    store.audit("page:anna", "reset", {"reason": "shift begins"})
    store.audit("page:boris", "set", {"mode": "maintenance", "reason": ""})
    refused = {"refused": "role of the person does not allow it", "reject_code": 268}
    store.audit("page:vera", "set", {"mode": "manual", "reason": "a look", **refused})
    store.close()


@pytest.fixture
def paper() -> PaperDaemon:
    return PaperDaemon()


@pytest.fixture(scope="session")
def secret() -> str:
    return secret_of(PIN)


@pytest.fixture(scope="session")
def two_runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store as it was closed; each test has a copy, which takes a tenth of writing one."""
    folder = tmp_path_factory.mktemp("store of the page")
    _store(folder)
    return folder


@pytest.fixture
def settings(tmp_path: Path, secret: str, two_runs: Path) -> Path:
    shutil.copytree(two_runs, tmp_path / "store")
    day = (datetime.now(UTC) + timedelta(days=1)).date()
    people = [
        f'[[people]]\nname = "{name}"\nrole = "{role}"\nsecret = "{secret}"\n'
        for name, role in (("anna", "operate"), ("boris", "maintain"), ("vera", "view"))
    ]
    tokens = [
        f'[[tokens]]\nname = "{name}"\nrole = "operate"\nexpires = {expires}\n'
        f'sha256 = "{hashlib.sha256((TOKEN + name).encode()).hexdigest()}"\n'
        for name, expires in (("line", day), ("old", "2020-01-01"))
    ]
    file = tmp_path / "hmi.toml"
    head = f'socket = "{tmp_path}/s"\ndata_dir = "{tmp_path}/store"\nport = 0\n'
    head += f'forwarder_dir = "{tmp_path}/forwarder"\n'
    file.write_text(f'{head}hosts = ["cell.example"]\n' + "".join(people + tokens))
    return file


@pytest.fixture
def page(settings: Path, paper: PaperDaemon) -> Iterator[Client]:
    with serving(settings.parent / "s", paper), page_thread(settings) as url:
        client = Client(url)
        client.until_live()
        yield client
