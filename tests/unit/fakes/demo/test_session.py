"""What a demonstration says of the computer that it ran on, and how one that stays ends."""

import io
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
