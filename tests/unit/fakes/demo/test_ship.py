"""What ships with the fake cell is what a demonstration has made, and cellctl can read it."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

from cellctl.calibration.store.envelope import StoredCalibration, read_calibration, write_stored
from fakes.demo.ship import ship

MADE = datetime(2026, 11, 21, 8, tzinfo=UTC)
RECORD = {"verdict": "pass", "mass_kg": 200.1, "words": "Größe µ"}


def test_shipped_files_are_those_of_the_run_without_a_last_day(tmp_path: Path) -> None:
    made = StoredCalibration("payload", RECORD, MADE, MADE + timedelta(days=1), "cellctl", "S-1")
    folder = tmp_path / "run" / "calibration"
    write_stored(folder, made)
    (folder / "payload.png").write_bytes(b"picture")
    (folder / "payload.invalidated.json").write_text("{}")
    ship(tmp_path / "run", tmp_path / "shipped")
    assert sorted(path.name for path in (tmp_path / "shipped").iterdir()) == [
        "payload.json",
        "payload.png",
    ]
    shipped = read_calibration(tmp_path / "shipped", "payload")
    assert (shipped.record, shipped.made, shipped.serial_number) == (RECORD, MADE, "S-1")
    assert shipped.valid_until.year == 9999
