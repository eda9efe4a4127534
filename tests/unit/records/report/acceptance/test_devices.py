"""The devices of a run with serial number, certificate and what they told; else *not stated*."""

from cellctl.records.report.acceptance.devices import devices
from cellctl.records.report.sections import ReportTable


def test_devices_say_what_they_can_be_traced_by() -> None:
    cell = {
        "robots": {"arm": {"driver": "siasun-sjl", "settings": {}}},
        "force_sensors": {
            "force": {
                "driver": "sri",
                "certificate": "DKD 4711, 2026-03-01",
                "settings": {"host": "10.0.0.2", "port": 4008, "serial_number": "S-12"},
            }
        },
        "stereo_cameras": {
            "head_1": {
                "driver": "gige",
                "settings": {"left": {"serial_number": "1"}, "right": {"serial_number": "2"}},
            }
        },
    }
    (table, _) = devices(cell, {"force": "S-12 (SFWV 1.2)"}).blocks
    assert isinstance(table, ReportTable)
    assert [tuple(cell.text for cell in row.cells) for row in table.rows] == [
        ("arm", "robot", "siasun-sjl", "–", "not stated", "not stated", "not stated"),
        ("head_1", "stereo camera", "gige", "–", "1, 2", "not stated", "not stated"),
        ("force", "force sensor", "sri", "10.0.0.2:4008", "S-12", "DKD 4711, 2026-03-01",
         "S-12 (SFWV 1.2)"),
    ]  # fmt: skip
