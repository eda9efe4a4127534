"""The demonstration holds an inserted part against the truth by every limit of its cell."""

from copy import deepcopy
from datetime import UTC, datetime
from typing import Any

import pytest

from cellctl.calibration.store.store import CalibrationStore
from cellctl.config.load import load_cell
from cellctl.processes.peg_in_hole.calibrations import CALIBRATIONS, CONTACT_LOOP
from cellctl.processes.peg_in_hole.settings import PegSettings
from cellctl.processes.peg_in_hole.stations import peg_recipes
from fakes.demo import registry
from fakes.demo.control import Control
from fakes.demo.demo import Evidence
from fakes.demo.processes.peg_in_hole import PegInHoleDemo
from fakes.scenes.socket.scenario import SocketScenario
from fakes.scenes.socket.scene import SocketScene

TRUTH: dict[str, Any] = {
    "seated": True,
    "hole_faults": [],
    "depth_mm": 11.98,
    "seat_depth_mm": 12.0,
    "slip_mm": 0.0,
    "peak_force_n": {"1_ms": 33.0, "3_ms": 31.0, "20_ms": 18.0},
    "peak_moment_nm": {"1_ms": 0.4, "3_ms": 0.3, "20_ms": 0.2},
    "unsolved_percent": 0.4,
}
RECORD: dict[str, Any] = {"figures": [{"key": "capture", "value": 1.0, "verdict": "pass"}]}
GOOD = {"result": "good", "run": 1}


def judged(
    truth: dict[str, Any] | None = None,
    record: dict[str, Any] | None = None,
) -> list[str]:
    """Names of what is beyond its limit; the verdict must agree with them."""
    evidence = Evidence(GOOD, deepcopy(TRUTH) | (truth or {}), record or deepcopy(RECORD))
    judgement = PegInHoleDemo().judge(evidence)
    beyond = list(judgement.figures["beyond"])
    assert judgement.passed == (not beyond)
    return beyond


def test_a_pin_at_its_seat_passes() -> None:
    assert judged() == []


def test_what_the_cell_calls_bad_is_not_good() -> None:
    assert not PegInHoleDemo().judge(Evidence({"result": "bad"}, deepcopy(TRUTH), {})).passed


@pytest.mark.parametrize(
    ("truth", "names"),
    [
        ({"seated": False}, ["seated"]),
        ({"seated": False, "depth_mm": 8.0}, ["true depth short of the seat, mm", "seated"]),
        ({"slip_mm": 0.2}, ["slip in the fingers, true, mm"]),
        ({"slip_mm": -0.2}, ["slip in the fingers, true, mm"]),
        (
            {"peak_force_n": {"1_ms": 90.0, "3_ms": 40.0, "20_ms": 31.0}},
            ["true force, 20 ms mean, N"],
        ),
        (
            {"peak_force_n": {"1_ms": 90.0, "3_ms": 51.0, "20_ms": 20.0}},
            ["true force, 3 ms mean, N"],
        ),
        (
            {"peak_moment_nm": {"1_ms": 2.0, "3_ms": 1.1, "20_ms": 0.2}},
            ["true moment at the tip, 3 ms mean, N·m"],
        ),
        ({"unsolved_percent": 2.5}, ["steps of the contact model without an equilibrium, %"]),
    ],
)
def test_every_figure_of_the_truth_has_its_limit(truth: dict[str, Any], names: list[str]) -> None:
    assert judged(truth) == names


def test_a_figure_of_the_record_that_failed_is_bad() -> None:
    failed = {"figures": [{"key": "capture", "value": 9.0, "verdict": "fail"}]}
    assert judged(record=failed) == ["capture of the record"]


def test_the_truth_of_the_scene_is_what_the_demonstration_judges() -> None:
    demo = registry.find("peg-in-hole")
    world = SocketScene(SocketScenario.read(demo.scenario), 1)
    judgement = demo.judge(Evidence(GOOD, world.report(), {}))
    assert not judgement.passed
    assert "seated" in judgement.figures["beyond"]
    assert demo.cell.is_file()


def test_every_job_begins_with_the_next_part() -> None:
    asked: list[str] = []

    class Hands(Control):
        def __init__(self) -> None:
            """No wire in between."""

        def request(self, cmd: str, **_: Any) -> dict[str, Any]:
            asked.append(cmd)
            return {}

    PegInHoleDemo().prepare(Hands())
    assert asked == ["load"]
    (loop,) = PegInHoleDemo.procedures
    loop.prepare(Hands(), PegInHoleDemo.cell)
    assert (loop.number, asked) == (301, ["load", "load"])


@pytest.mark.parametrize("name", ["connector", "pin"])
def test_a_shipped_cell_comes_with_the_measured_loop(name: str) -> None:
    cell = PegInHoleDemo.cells[name]
    config = load_cell(cell)
    (recipe,) = peg_recipes(config)
    kind = CONTACT_LOOP.for_recipe(recipe.id)
    store = CalibrationStore(cell.parent / str(config.calibration_dir), CALIBRATIONS)
    figures = store.read_all([kind], datetime.now(UTC)).find(kind)
    assert figures is not None
    settings = config.processes["peg-in-hole"]
    assert isinstance(settings, PegSettings)
    # Better than the bounds, or nothing would be gained by measuring.
    assert figures.loop_n_s_m < 0.7 * settings.stiffness_n_mm * settings.dead_time_ms


NOW: dict[str, Any] = {
    "state": "EXECUTE",
    "step_number": 30,
    "error_mm": [0.1, 0.0, -4.25],
    "force_z_n": -7.5,
    "force_peaks": [1.0, 2.0, 9.0, 0.11, 0.02, 0.0],
    "force_limit_n": None,
    "doing": "search: spiral; first contact: end face",
}


def test_the_live_view_shows_contact_depth_force_and_moments() -> None:
    rows = PegInHoleDemo().rows(NOW)
    assert "end face" in rows["contact"]
    assert rows["to the seat"].strip() == "4.25 mm"
    assert "-7.50 N" in rows["force z"]
    assert rows["moments"] == "peaks 0.11, 0.02, 0.00 N·m"


def test_a_new_class_of_contact_is_worth_a_line() -> None:
    demo = PegInHoleDemo()
    assert "doing" in demo.telling
    assert demo.news(NOW, NOW | {"doing": "insert: aligned"}) == "insert: aligned"
    assert demo.news(NOW, NOW) is None
    assert demo.news(NOW, NOW | {"state": "COMPLETE", "doing": "over"}) is None


def test_before_any_contact_nothing_is_claimed() -> None:
    empty = {"state": "EXECUTE", "step_number": 0}
    assert set(PegInHoleDemo().rows(empty).values()) == {"-"}
