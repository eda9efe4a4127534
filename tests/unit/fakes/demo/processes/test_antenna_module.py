"""The demonstration holds a plugged module against the truth by every limit of a good plug."""

from copy import deepcopy
from typing import Any

import pytest

from fakes.demo.control import Control
from fakes.demo.demo import Evidence
from fakes.demo.processes.antenna_module import AntennaModuleDemo
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.scene import AntennaBench

NAMES = [str(number) for number in range(1, 16)]
TRUTH: dict[str, Any] = {
    "module": "socket",
    "pins": dict.fromkeys(NAMES, "inside"),
    "bent": [],
    "met_offset_at_worst_contact_mm": 0.021,
    "seated_depth_mm": 2.53,
    "seat_depth_mm": 2.5,
    "peak_side_n": dict.fromkeys(NAMES, 0.2),
    "peak_axial_n": dict.fromkeys(NAMES, 0.4),
    "peak_total_n": 31.0,
}
RECORD: dict[str, Any] = {"figures": [{"key": "predicted_p99", "value": 0.04, "verdict": "pass"}]}
GOOD = {"result": "good", "run": 1}


def judged(truth: dict[str, Any] | None = None, record: dict[str, Any] | None = None) -> list[str]:
    """Names of what is beyond its limit; the verdict must agree with them."""
    changed = deepcopy(TRUTH) | (truth or {})
    judgement = AntennaModuleDemo().judge(Evidence(GOOD, changed, record or deepcopy(RECORD)))
    beyond = list(judgement.figures["beyond"])
    assert judgement.passed == (not beyond)
    return beyond


def test_a_good_plug_passes() -> None:
    assert judged() == []


def test_what_the_cell_calls_bad_is_not_good() -> None:
    evidence = Evidence({"result": "bad"}, deepcopy(TRUTH), deepcopy(RECORD))
    assert not AntennaModuleDemo().judge(evidence).passed


@pytest.mark.parametrize(
    ("truth", "names"),
    [
        ({"module": "gripper"}, ["place of the module"]),
        ({"pins": TRUTH["pins"] | {"4": "standing"}}, ["pins inside"]),
        ({"pins": TRUTH["pins"] | {"4": "collapsed"}}, ["pins inside", "bent or collapsed pins"]),
        ({"bent": ["4"]}, ["bent or collapsed pins"]),
        (
            {"met_offset_at_worst_contact_mm": 0.051},
            ["true offset at the worst contact as it met, mm"],
        ),
        (
            {"met_offset_at_worst_contact_mm": None},
            ["true offset at the worst contact as it met, mm"],
        ),
        ({"seated_depth_mm": 2.2}, ["true depth beyond the seat, mm"]),
        ({"seated_depth_mm": 2.7}, ["true depth beyond the seat, mm"]),
        (
            {"peak_side_n": TRUTH["peak_side_n"] | {"9": 3.1}},
            ["highest side force on a contact, true, N"],
        ),
        (
            {"peak_axial_n": TRUTH["peak_axial_n"] | {"9": 20.5}},
            ["highest axial force on a contact, true, N"],
        ),
        ({"peak_total_n": 52.5}, ["highest force of the insertion, true, N"]),
    ],
)
def test_every_figure_of_the_truth_has_its_limit(truth: dict[str, Any], names: list[str]) -> None:
    assert judged(truth) == names


def test_a_figure_of_the_record_that_failed_is_bad() -> None:
    failed = {"figures": [{"key": "seated", "value": 0.2, "verdict": "fail"}]}
    assert judged(record=failed) == ["seated of the record"]


def test_a_module_that_never_came_to_its_socket_shows_no_figures() -> None:
    lying = deepcopy(TRUTH) | {
        "module": "tray",
        "pins": dict.fromkeys(NAMES, "outside"),
        "met_offset_at_worst_contact_mm": None,
        "seated_depth_mm": 140.0,
    }
    judgement = AntennaModuleDemo().judge(Evidence({"result": "bad"}, lying, {}))
    rows = {row.name: row.value for row in judgement.rows}
    assert rows["module"] == "tray"
    assert rows["true depth beyond the seat, mm"] is None
    assert rows["true offset at the worst contact as it met, mm"] is None


def test_the_truth_of_the_bench_is_what_the_demonstration_judges(
    bench_scenario: BenchScenario,
) -> None:
    """Every figure is there, and a module on its tray is no good part."""
    truth = AntennaBench(bench_scenario, 1).report()
    judgement = AntennaModuleDemo().judge(Evidence(GOOD, truth, {}))
    assert not judgement.passed
    assert judgement.figures["module"] == "tray"
    assert judgement.figures["pins"] == 15


class Bench(Control):
    """The control port of a bench, without a wire in between."""

    def __init__(self, world: AntennaBench) -> None:
        self.world = world
        self.asked: list[str] = []
        self.last: dict[str, dict[str, Any]] = {}
        """Arguments of the last request of each command."""

    def request(self, cmd: str, **arguments: Any) -> dict[str, Any]:
        self.asked.append(cmd)
        self.last[cmd] = arguments
        return dict(self.world.commands()[cmd](**arguments) or {})


def test_the_bench_does_what_the_operator_prepares(bench_scenario: BenchScenario) -> None:
    bench = Bench(AntennaBench(bench_scenario, 1))
    boards = {}
    for procedure in AntennaModuleDemo.procedures:
        procedure.prepare(bench, AntennaModuleDemo.cell)
        boards[procedure.number] = bench.world.operator.board_at
    assert boards == {
        201: "table", 202: "flange", 203: "table", 204: "flange", 205: None, 206: None,
        207: None
    }  # fmt: skip
    assert bench.world.loads == 2
    assert bench.asked[-1] == "stand_by"


def test_nobody_stands_by_in_production(bench_scenario: BenchScenario) -> None:
    """A plug rests above its socket there, too, and the hands must not take it."""
    bench = Bench(AntennaBench(bench_scenario, 1))
    bench.request("stand_by", on=True)
    bench.request("place_board", where="table")
    AntennaModuleDemo().prepare(bench)
    assert bench.world.operator.board_at is None
    assert bench.last["stand_by"] == {"on": False}
