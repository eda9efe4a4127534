"""The pages of an insertion, also of one that another version has recorded."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from cellctl.processes.peg_in_hole.offline.task_file import JudgedPart
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.report.pages import pages
from cellctl.records.entries import RunRecord
from cellctl.records.report.sections import Drawing
from tests.rigs.sweeps import sweep
from tests.unit.processes.peg_in_hole.record.test_tick_log import ticked


@pytest.mark.parametrize(
    "task", sweep((None, {}, {"fit": {"bore": 1.0}}, {"version": 99}), ({"fit": {"bore": 1.0}},))
)
def test_forces_are_drawn_whatever_the_record_says_of_the_task(task: dict[str, Any] | None) -> None:
    made = pages(recorded(task or {}), lambda _artefact: ticked(20).text().encode())
    (section,) = made.sections
    assert any(isinstance(block, Drawing) for block in section.blocks)


def recorded(task: dict[str, Any]) -> RunRecord:
    documents = {keys.TASK: task}
    record = SimpleNamespace(
        head=SimpleNamespace(mode="production", result="good"),
        newest_figures={},
        artefacts=[SimpleNamespace(name=keys.ticks(keys.INSERTION))],
        document=lambda key: documents.get(key, {}),
        value=lambda _key: None,
    )
    return cast(RunRecord, record)


@pytest.mark.parametrize(("depth_mm", "drawn"), [(1.9, True), (1.2, False)])
def test_nearness_of_a_jam_is_drawn_only_before_the_seat(depth_mm: float, drawn: bool) -> None:
    # The ticks end at 1.9 mm: 0.3 mm before a seat at 1.2 mm nothing can be told yet.
    part = {
        "fit": {
            "peg_radius_mm": 0.5, "clearance_mm": 0.02, "hole_chamfer_mm": 0.3,
            "peg_chamfer_mm": 0.3, "depth_mm": depth_mm, "friction": 0.2,
        },
        "seat": {"least_n": 5.0, "most_n": 30.0, "grip_n": 60.0},
        "cell": {"stiffness_n_mm": 100.0, "force_sigma_n": 0.1},
    }  # fmt: skip
    JudgedPart.model_validate(part)
    made = pages(recorded(part), lambda _artefact: ticked(20).text().encode())
    (section,) = made.sections
    (captions, _) = (block.caption for block in section.blocks if isinstance(block, Drawing))
    assert ("Jam ratio" in captions) is drawn
