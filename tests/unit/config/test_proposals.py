"""What `cellctl check` proposes is the value that was there, or it proposes nothing."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config.commissioning import examine_before_commissioning
from tests.unit.config.test_mistakes import written

_POSES = (
    "base_T_frame",
    # Each is eighteen checks of the whole file, and all go the same way.
    *(
        pytest.param(name, marks=pytest.mark.figures)
        for name in ("deck_measure", "measuring", "flange_T_camera", "flange_T_deck")
    ),
)
_PROPOSED = re.compile(r"did you mean (\[[^\]]*\])")


def _edits(before: list[float]) -> Iterator[list[float]]:
    """A sign, and 10 mm or degrees to either side, of each figure."""
    for index, figure in enumerate(before):
        for other in {-figure, figure + 10.0, figure - 10.0} - {figure}:
            yield [*before[:index], other, *before[index + 1 :]]


def _first_value(text: str, name: str) -> str:
    match = re.search(rf"^{name} = (\[[^\]]*\])", text, re.MULTILINE)
    assert match is not None
    return match[1]


@pytest.mark.parametrize("name", _POSES)
def test_a_proposal_is_the_value_that_was_there(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, "deck.toml")
    text = path.read_text()
    before = _first_value(text, name)
    for edited in _edits(json.loads(before)):
        path.write_text(text.replace(f"{name} = {before}", f"{name} = {edited}", 1))
        for issue in examine_before_commissioning(path).errors:
            for proposed in _PROPOSED.findall(issue.allowed):
                assert proposed == before, (edited, issue)
                assert issue.key.endswith(f".{name}")


def test_a_pose_10_degrees_off_is_named_with_all_that_it_contradicts(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", "33.6262, 90.0]", "43.6262, 90.0]")
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 1
    assert "no other one decides which is wrong" in done.output
    assert "line 22: robots.main.poses_deg.deck_measure = [0.0, -52.76637" in done.output
    assert "recipes.0.flange_T_deck = [0.0, 0.0, 502.0" in done.output
    assert "did you mean" not in done.output


def test_without_calibrations_a_head_that_sees_nothing_is_no_proof_of_its_mounting(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, "deck.toml", "120.0, 0.0, 10.0, 0.0]", "120.0, 0.0, 60.0, 0.0]")
    path.write_text(path.read_text().replace('"demo-calibration"', '"none"'))
    (issue,) = examine_before_commissioning(path).errors
    assert "did you mean" not in issue.allowed
    assert {issue.key, *(one.key for one in issue.against)} >= {
        "stereo_cameras.head_1.flange_T_camera",
        "robots.aux_1.poses_deg.measuring",
        "recipes.0.base_T_frame",
        "robots.main.poses_deg.deck_measure",
    }


def test_a_good_file_says_what_nobody_can_know(tmp_path: Path) -> None:
    done = CliRunner().invoke(whole_app(), ["check", str(written(tmp_path, "deck.toml"))])
    assert done.exit_code == 0
    assert "less than 100 mm and 10 deg" in done.output
    assert "only the cell shows" in done.output
