"""The pages of an insertion, also of one that another version has recorded."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.report.pages import pages
from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import Drawing
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked


@pytest.mark.parametrize("task", [None, {}, {"fit": {"bore": 1.0}}, {"version": 99}])
def test_forces_are_drawn_whatever_the_record_says_of_the_task(task: dict[str, Any] | None) -> None:
    documents = {keys.TASK: task}
    record = SimpleNamespace(
        newest_figures={},
        artefacts=[SimpleNamespace(name=keys.ticks(keys.INSERTION))],
        document=documents.get,
    )
    made = pages(cast(RunRecord, record), lambda _artefact: ticked(20).text().encode())
    (section,) = made.sections
    assert any(isinstance(block, Drawing) for block in section.blocks)
