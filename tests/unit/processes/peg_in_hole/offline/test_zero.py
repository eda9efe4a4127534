"""A recorded curve whose sensor was not tared, told by what it shows over the face."""

from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.peg_in_hole.faults import PegCurveInvalid
from cellctl.processes.peg_in_hole.offline.judge import judge_by_task
from tests.rigs.insertion.curves import NAMES, TASK, Array, Inserted, as_csv, inserted

Motions = list[tuple[int, str]]
SAID = "Nothing was recorded higher than 0.5 mm over the face"


def approached(off_n: tuple[float, float, float], above_mm: float = 2.0) -> tuple[Array, Motions]:
    """A good insertion with this zero, and the way from above before it."""
    rows, kinds = inserted(Inserted())
    above = np.zeros((60, len(NAMES)))
    above[:, 0] = np.arange(60) * 0.01
    above[:, 3] = np.linspace(-above_mm, -0.01, 60)
    above[:, 4:7] = np.random.default_rng(1).normal(0.0, 0.02, (60, 3))
    rows[:, 0] += 0.6
    rows = np.vstack([above, rows])
    rows[:, 4:7] += off_n
    return rows, [(0, "move_free")] * 60 + kinds


def written(folder: Path, rows: Array, kinds: Motions) -> tuple[Path, Path]:
    curve, task = folder / "insertion.csv", folder / "task.toml"
    curve.write_bytes(as_csv(rows, kinds))
    task.write_text(TASK)
    return curve, task


@pytest.mark.parametrize(
    ("off_n", "name"),
    [((0.0, 0.0, -1.8), "fz_n"), ((0.0, 0.0, 1.8), "fz_n"), ((1.4, 0.0, 0.0), "fx_n")],
)
def test_a_zero_that_the_verdict_hides_is_refused(
    tmp_path: Path, off_n: tuple[float, float, float], name: str
) -> None:
    """Neither 1.8 N with the feed nor 1.8 N more at the seat are out of any other limit."""
    curve, task = written(tmp_path, *approached(off_n))
    with pytest.raises(PegCurveInvalid, match=rf"{name} is .* N in the mean higher .* tare"):
        judge_by_task(curve, task)


def test_a_tared_curve_is_judged_without_a_word_of_its_zero(tmp_path: Path) -> None:
    curve, task = written(tmp_path, *approached((0.0, 0.0, -0.2)))
    judged = judge_by_task(curve, task)
    assert judged.good
    assert judged.said == ()


def test_a_curve_that_begins_at_the_face_says_that_its_zero_is_not_known(tmp_path: Path) -> None:
    curve, task = written(tmp_path, *approached((0.0, 0.0, 0.0), above_mm=0.4))
    judged = judge_by_task(curve, task)
    assert judged.good
    assert any(SAID in sentence for sentence in judged.said)
    assert any(SAID in sentence for sentence in judged.record["left_open"])
