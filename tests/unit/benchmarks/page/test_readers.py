"""Readers of the benchmark before the page of a daemon made of paper."""

import time
from pathlib import Path

import pytest

from benchmarks.page.clients import readers
from benchmarks.page.readers import STREAMS_EACH, add_readers
from cellctl.hmi.event_stream import STREAMS_EACH as LET_IN
from fakes.demo.page import write_settings
from tests.unit.hmi.scripted_daemon import PaperDaemon, page_thread, serving

COUNT = 6


@pytest.mark.parametrize("programs", [COUNT, STREAMS_EACH])
def test_all_readers_hear_the_cell_or_it_is_said_who_was_not_let_in(
    tmp_path: Path, programs: int
) -> None:
    assert STREAMS_EACH == LET_IN
    settings, _ = write_settings(tmp_path)
    add_readers(settings, programs)
    (tmp_path / "store").mkdir()
    with serving(tmp_path / "store/cellctl.sock", PaperDaemon()), page_thread(settings) as url:
        with readers(url, COUNT) as heard:
            time.sleep(1.0)
        (found,) = heard
    assert len(found.refused) == COUNT - programs
    assert len(found.late_s) > 3 * programs, "the paper cell says something twenty times a second"
    assert 0.0 < max(found.late_s) < 5.0
