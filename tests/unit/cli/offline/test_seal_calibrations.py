"""`cellctl calibrate seal`: files of an earlier version, with who has compared their dates."""

import hashlib
import json
from pathlib import Path

from typer.testing import CliRunner

from cellctl.calibration.store.envelope import read_calibration
from cellctl.cli.commands import whole_app
from cellctl.cli.os_user import terminal_user
from cellctl.records.store import RunStore
from tests.unit.calibration.store.shipped import renew_calibrations
from tests.unit.cell.bench import CELL_FILE


def test_who_sealed_what_is_printed_and_in_the_audit_log(tmp_path: Path) -> None:
    text = CELL_FILE.read_text(encoding="utf-8").replace("demo-calibration", "calibration")
    (tmp_path / "features").symlink_to(CELL_FILE.parent / "features")
    (tmp_path / "cell.toml").write_text(text.replace("runs/cell", str(tmp_path / "store")))
    renew_calibrations(tmp_path / "calibration")
    path = tmp_path / "calibration" / "payload.json"
    data = json.loads(path.read_text())
    canonical = json.dumps(data["record"], sort_keys=True, separators=(",", ":"))
    old = {key: data[key] for key in data if key != "format"}
    path.write_text(json.dumps(old | {"id": hashlib.sha256(canonical.encode()).hexdigest()}))
    RunStore(tmp_path / "store").close()

    arguments = ["calibrate", "seal", "--by", "OP-3", "--cell", str(tmp_path / "cell.toml")]
    result = CliRunner().invoke(whole_app(), arguments, catch_exceptions=False)

    assert result.exit_code == 0, result.output
    assert "payload: made 20" in result.output
    assert "serial number M4347K-1" in result.output
    assert "1 files sealed" in result.output
    store = RunStore(tmp_path / "store", create=False)
    entry = store.audit_log()[-1]
    store.close()
    assert (entry.actor, entry.action) == (terminal_user(), "calibrations sealed")
    assert entry.detail["by"] == "OP-3"
    stored = read_calibration(tmp_path / "calibration", "payload")
    assert entry.detail["ids"] == {"payload": stored.id}
