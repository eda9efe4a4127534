"""A plug and a pin that find their holes by touch on fake cells, as `make demo-insertion` does."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl.errors.calibration import CalibrationInvalidated
from cellctl.processes.peg_in_hole.faults import PanelOffReference
from tests.rigs.whole_cell.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(400), pytest.mark.long]
PROCESS = ("--process", "peg-in-hole")


@pytest.fixture(params=["insertion-pin"])
def pin(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[OwnCell]:
    cell = OwnCell.make(tmp_path, request.param)
    yield cell
    cell.kill_all()


# The last arm is streamed to over its remote interface; the process is the same.
@pytest.mark.parametrize(
    "pin", ["insertion-connector", "insertion-pin", "insertion-pin-rpc"], indirect=True
)
def test_a_part_is_found_and_inserted(pin: OwnCell) -> None:
    out = pin.folder / "run"
    demo = pin.demo(out, *PROCESS, "--seed", "1")
    assert demo.end(300) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["passed"]
    assert result["seated"]
    assert abs(result["short_mm"]) < 0.3
    assert result["force_20_ms_n"] < (80.0 if "connector" in pin.shipped else 30.0)
    page = (out / "report" / "report.html").read_text(encoding="utf-8")
    assert "where the peg touched the face" in page
    assert "Forces and moments of the hole on the peg" in page


@pytest.mark.parametrize(
    ("fault", "alarms"),
    [("world:hole_absent", ("F547", "F548")), ("world:blocked", ("F552", "F554"))],
)
def test_a_pin_that_cannot_be_inserted_is_not_called_good(
    pin: OwnCell, fault: str, alarms: tuple[str, ...]
) -> None:
    out = pin.folder / "run"
    demo = pin.demo(out, *PROCESS, "--seed", "1", "--fault", fault)
    assert demo.end(350) != 0
    demo.nobody_left()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["result"] != "good"
    assert not result["seated"]
    assert result["fault"].startswith(alarms)
    # Drawn out to 10 mm over the face, from a seat that is 12 mm deep.
    assert result["short_mm"] > 21.0


@pytest.mark.parametrize(
    "pin", ["insertion-connector", "insertion-pin", "insertion-pin-rpc"], indirect=True
)
def test_the_loop_is_measured_and_used(pin: OwnCell) -> None:
    pin.fake().ready()
    pin.daemon().ready()
    plc = pin.plc("--mode", "maintenance", "--recipe", "301")
    assert plc.end(200) == 0, plc.stdout + plc.stderr
    stored = json.loads((pin.calibration / "contact_loop_1.json").read_text(encoding="utf-8"))
    record = stored["record"]
    assert record["verdict"] == "pass"
    # Fingers, wrist and arm of the scenario in series with the face, and what the wire costs.
    assert 80.0 < record["stiffness_n_mm"] < 120.0
    assert 5.0 < record["dead_time_ms"] < 60.0
    assert record["fitted"]["dead_time_ms"] < 60.0


TURNED_DEG = 0.15
"""Turn of the joint that lifts the arm, by which the tip comes 1.3 mm beside its place."""


def test_an_arm_that_was_mastered_anew_is_found_at_the_panel(pin: OwnCell) -> None:
    pin.fake().ready()
    daemon = pin.daemon()
    daemon.ready()

    def take_reference() -> None:
        reference = pin.plc("--mode", "maintenance", "--recipe", "302")
        assert reference.end(100) == 0, reference.stdout

    take_reference()
    same = pin.plc("--serial", "SAME")
    assert same.end(200) == 0, same.stdout
    take_reference()  # the peg is out of the hole then
    with pin.control() as control:
        control.request("master", robot="arm", joint=2, deg=TURNED_DEG)
    moved = pin.plc("--serial", "MOVED")
    assert moved.end(100) != 0
    daemon.logged("fault", number=PanelOffReference.number)
    again = pin.plc("--serial", "AGAIN")
    assert again.end(60) != 0
    daemon.logged("fault", number=CalibrationInvalidated.number)
    take_reference()
