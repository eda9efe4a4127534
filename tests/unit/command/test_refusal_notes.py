"""Refusals by the thousand leave room on the disk, and their number is not lost."""

from cellctl.command.refusal_notes import NOTED_A_MINUTE, RefusalNotes
from cellctl.packml.unit_command import Source


def test_what_is_left_out_is_counted_and_each_source_has_its_own_minute() -> None:
    time_s = 0.0
    notes = RefusalNotes(clock=lambda: time_s)
    line = [notes.take(Source.LINE) for _ in range(NOTED_A_MINUTE + 40)]
    assert line == [0] * NOTED_A_MINUTE + [None] * 40
    assert notes.take(Source.TERMINAL) == 0
    time_s = 60.0
    assert [notes.take(Source.LINE) for _ in range(2)] == [40, 0]
