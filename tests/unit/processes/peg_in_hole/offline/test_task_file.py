"""Tasks whose figures contradict each other, as those of a recipe may not."""

from pathlib import Path

import pytest

from cellctl.errors.config import FileInvalid
from cellctl.processes.peg_in_hole.offline.judge import judge_by_task
from cellctl.processes.peg_in_hole.offline.task_file import parse_part
from tests.rigs.insertion.curves import TASK, Inserted, as_csv, inserted


@pytest.mark.parametrize(
    ("old", "new", "key", "said"),
    [
        ("clearance_mm = 0.05", "clearance_mm = 5.0", "fit.clearance_mm = 5", "half of peg_rad"),
        ("least_n = 5.0", "least_n = 35.0", "seat = 35, 30", "least_n < most_n"),
        ("least_n = 5.0", "least_n = 1.0", "seat.least_n = 1", "at least 2: 20 force_sigma_n"),
        ("depth_mm = 12.0", "depth_mm = 0.2", "fit.depth_mm = 0.2", "between the walls only"),
        (
            "depth_mm = 12.0",
            "depth_mm = 12.0\npeg_chamfer_mm = 2.0",
            "fit.peg_chamfer_mm = 2",
            "no front",
        ),
        (
            "depth_mm = 12.0",
            "depth_mm = 12.0\ncontacts = { depth_mm = 6, full_mm = 5, least_n = 9, most_n = 8 }",
            "fit.contacts.least_n = 9",
            "at most 8",
        ),
        ("most_n = 30.0", "most_n = 30.0\npull_n = 9.0", "seat.least_n = 5", "pull_n"),
    ],
)
def test_a_task_that_contradicts_itself_is_refused_with_its_key(
    old: str, new: str, key: str, said: str
) -> None:
    assert old in TASK
    with pytest.raises(FileInvalid, match="F105") as refused:
        parse_part(TASK.replace(old, new))
    assert key in refused.value.detail
    assert said in refused.value.detail


def test_a_clearance_that_few_parts_have_is_said(tmp_path: Path) -> None:
    """A diametral or tenfold one lets another hole pass: nothing else in a curve contradicts it."""
    curve, task = tmp_path / "c.csv", tmp_path / "task.toml"
    curve.write_bytes(as_csv(*inserted(Inserted())))
    task.write_text(TASK)
    (of_the_zero,) = judge_by_task(curve, task).said
    assert of_the_zero.startswith("Nothing was recorded higher than 0.5 mm over the face")
    task.write_text(TASK.replace("clearance_mm = 0.05", "clearance_mm = 0.5"))
    said, _ = judge_by_task(curve, task).said
    assert said.startswith("fit.clearance_mm = 0.5 is wider than the fits of parts of this size")
