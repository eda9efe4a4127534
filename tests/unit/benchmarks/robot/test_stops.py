"""The table of stops: each way stops an arm, and a way that is too slow is said to be."""

import pytest

from benchmarks.robot.stop_methods import WAYS
from benchmarks.robot.stops import StopRow, main, table


def test_the_digital_output_stops_beside_the_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--repeats", "1", "--way", "digital output of the PC"]) == 0
    assert "no program of it" in capsys.readouterr().out


@pytest.mark.parametrize("name", [name for name in WAYS if "silent" not in name])
def test_every_way_is_in_the_table(name: str) -> None:
    row = StopRow(name, WAYS[name][0], 30, 1.0, 2.0, WAYS[name][2], WAYS[name][2])
    assert row.kept
    assert "exceeded" not in table([row])


def test_a_bound_that_is_exceeded_is_said() -> None:
    assert "**exceeded**" in table([StopRow("GRD", "its job", 30, 10.0, 290.0, 301.0, 300.0)])
