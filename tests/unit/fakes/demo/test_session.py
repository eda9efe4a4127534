"""What a demonstration says of the computer that it ran on, and how one that stays ends."""

import io
import signal
from pathlib import Path

import pytest
from rich.console import Console

from fakes.demo.children import ChildFailed, Family
from fakes.demo.registry import find
from fakes.demo.session import Files, Session, too_slow

DIES_ONCE = """
import os, pathlib, signal, sys
print('{"ready": true, "modbus_port": 1502}', flush=True)
first = pathlib.Path(sys.argv[1])
if not first.exists():
    first.touch()
    os.kill(os.getpid(), signal.SIGKILL)
print("it ended by itself", file=sys.stderr)
"""


FAULTS_AND_STAYS = """
import signal, sys
signal.signal(signal.SIGUSR1, lambda *_: sys.exit("it ended by itself"))
print('{"number": 207, "fault": "F207 Data too old: force", "remedy": "Look."}', file=sys.stderr)
print('{"ready": true, "modbus_port": 1502}', flush=True)
while True:
    signal.pause()
"""


class Hands:
    """The control port of a fake cell that has lost so much at each look; two are enough."""

    def __init__(self, family: Family, lost_s: float) -> None:
        self._family, self._lost_s, self._looks = family, lost_s, 0

    def request(self, cmd: str) -> dict[str, dict[str, float]]:
        assert cmd == "truth"
        self._looks += 1
        if self._looks == 2:
            self._family.children[0].process.send_signal(signal.SIGUSR1)
        return {"truth": {"lost_s": self._lost_s}}


def test_it_says_how_much_was_lost_and_what_to_do() -> None:
    said = too_slow(lost_s=5.3, passed_s=72.4)
    assert "5.3 s of 72 s" in said
    assert "run it again" in said


def test_a_daemon_that_was_killed_is_started_again_and_one_that_ended_is_not(
    tmp_path: Path,
) -> None:
    words = io.StringIO()
    said = Console(file=words, width=200)
    files = Files(tmp_path / "none.toml", tmp_path / "none.toml", tmp_path)
    with Family() as family:
        session = Session(
            find("deck-to-frame"), files, 1, family=family, console=said, complaint=said
        )
        session._daemon_command = ["-c", DIES_ONCE, str(tmp_path / "first")]
        session._spawn_daemon("daemon")
        with pytest.raises(ChildFailed, match="it ended by itself"):
            session.run(calibrate=False, stay=True)
    assert f"its cell file:      {tmp_path / 'none.toml'}" in words.getvalue()
    assert "killed by SIGKILL" in words.getvalue()
    assert (tmp_path / "daemon.log").exists()
    assert (tmp_path / "daemon-2.log").exists()


@pytest.mark.parametrize("lost_s", [0.0, 7.5])
def test_a_cell_that_stays_says_beside_a_fault_that_the_computer_was_too_slow(
    tmp_path: Path, lost_s: float
) -> None:
    words = io.StringIO()
    said = Console(file=words, width=200)
    files = Files(tmp_path / "none.toml", tmp_path / "none.toml", tmp_path)
    with Family() as family:
        session = Session(
            find("deck-to-frame"), files, 1, family=family, console=said, complaint=said,
            look_s=0.01,
        )  # fmt: skip
        session._control = Hands(family, lost_s)  # type: ignore[assignment]
        session._daemon_command = ["-c", FAULTS_AND_STAYS]
        session._spawn_daemon("daemon")
        with pytest.raises(ChildFailed, match="it ended by itself"):
            session.run(calibrate=False, stay=True)
    told = words.getvalue()
    assert told.count("F207 Data too old: force") == told.count("no processor for 7.5 s")
    assert ("this computer was too slow" in told) == bool(lost_s)


def test_a_cell_that_stays_outlives_hands_that_do_not_answer(tmp_path: Path) -> None:
    class Silent:
        def request(self, _cmd: str) -> None:
            family.children[0].process.send_signal(signal.SIGUSR1)
            raise TimeoutError

    said = Console(file=io.StringIO())
    files = Files(tmp_path / "none.toml", tmp_path / "none.toml", tmp_path)
    with Family() as family:
        session = Session(
            find("deck-to-frame"), files, 1, family=family, console=said, complaint=said,
            look_s=0.01,
        )  # fmt: skip
        session._control = Silent()  # type: ignore[assignment]
        session._daemon_command = ["-c", FAULTS_AND_STAYS]
        session._spawn_daemon("daemon")
        with pytest.raises(ChildFailed, match="it ended by itself"):
            session.run(calibrate=False, stay=True)
