"""Times from a call to its acceptance: every way is measured beside the bare socket."""

import pytest

from benchmarks.robot.acks import WAYS, AckRow, main, table


@pytest.mark.parametrize(
    "way", ["SJL/1", pytest.param("remote interface (RPC)", marks=pytest.mark.figures)]
)
def test_a_way_is_measured_beside_a_bare_socket(
    way: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--way", way, "--calls", "3"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith(f"| {way}")]
    assert len(lines) == (1 if "RPC" in way else 2)
    for line in lines:
        calls, p50, p99, most, bare, _, stall = (float(cell) for cell in line.split("|")[2:-1])
        assert calls == 3
        assert 0.0 < p50 <= p99 <= most
        assert bare > 0.0
        assert stall >= 0.0


@pytest.mark.figures  # a second measurement
def test_jobs_cannot_answer_before_they_have_read_their_command(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """About 70 statements lie between a command and its answer, each of 1 ms here."""
    assert main(["--way", "jobs, 1 ms a statement", "--calls", "2"]) == 0
    for line in capsys.readouterr().out.splitlines()[2:4]:
        assert float(line.split("|")[3]) > 30.0


def test_every_way_is_in_the_table() -> None:
    rows = [AckRow(way, 10, 1.0, 2.0, 3.0, 0.1, 0.2, 7.0) for way in WAYS]
    figures = "10 | 1.00 | 2.00 | 3.00 | 0.10 | 0.20 | 7"
    assert all(f"| {way} | {figures} |" in table(rows) for way in WAYS)
