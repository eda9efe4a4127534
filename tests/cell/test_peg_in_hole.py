"""A pin that finds its hole by touch on the fake cell, as `make demo-insertion` does it."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cell.rigs.own_cell import OwnCell

pytestmark = [pytest.mark.timeout(400), pytest.mark.long]
PROCESS = ("--process", "peg-in-hole")


@pytest.fixture
def pin(tmp_path: Path) -> Iterator[OwnCell]:
    cell = OwnCell.make(tmp_path, "insertion-pin")
    yield cell
    cell.kill_all()


def test_a_pin_is_found_and_inserted(pin: OwnCell) -> None:
    out = pin.folder / "run"
    demo = pin.demo(out, *PROCESS, "--seed", "1")
    assert demo.end(300) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["passed"]
    assert result["seated"]
    assert abs(result["short_mm"]) < 0.3
    assert result["force_20_ms_n"] < 30.0
    page = (out / "report" / "report.html").read_text(encoding="utf-8")
    assert "where the peg touched the face" in page
    assert "Forces and moments of the hole on the peg" in page


@pytest.mark.parametrize("fault", ["world:hole_absent", "world:blocked"])
def test_a_pin_that_cannot_be_inserted_is_not_called_good(pin: OwnCell, fault: str) -> None:
    out = pin.folder / "run"
    demo = pin.demo(out, *PROCESS, "--seed", "1", "--fault", fault)
    assert demo.end(350) != 0
    demo.nobody_left()
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["result"] != "good"
    assert not result["seated"]
