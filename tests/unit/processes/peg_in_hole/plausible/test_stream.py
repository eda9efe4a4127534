"""Turns of the cycle against those that the stream allows."""

from pathlib import Path

from cellctl.config import problems_before_commissioning
from tests.unit.config.test_mistakes import written

NEEDED_DEG = 6.2
"""1.5 times the 1.8 of the sweep; from there 2 times 1.0 of play and 1.5 that arm and fingers
yield."""


def said_of(folder: Path, allowed_deg: float) -> list[str]:
    """What the check says of a stream that turns by no more than this."""
    old, new = (f"max_stream_travel_deg = {value}" for value in (15.0, allowed_deg))
    path = written(folder, "insertion-connector.toml", old, new)
    found = problems_before_commissioning(path)
    return [issue.allowed for issue in found if "stream_travel_deg" in issue.key]


def test_the_turns_of_a_keyed_plug_add_up(tmp_path: Path) -> None:
    """Keys may drop at the end of the sweep, and the turn of the verdict begins there."""
    (said,) = said_of(tmp_path / "less", NEEDED_DEG - 0.1)
    assert f"at least {NEEDED_DEG:.1f}" in said
    assert not said_of(tmp_path / "more", NEEDED_DEG + 0.1)
