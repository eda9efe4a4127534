"""`cellctl teach` without an arm: it asks what is meant and writes what `check` would accept."""

import re
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.cli.commissioning.teach import write_pose
from cellctl.config import load_cell, problems_before_commissioning
from cellctl.config.document.taught_pose_text import with_pose
from cellctl.errors.config import ConfigInvalid

CONFIG = Path(__file__).parents[4] / "config"


def copy_of(name: str, folder: Path) -> Path:
    """A cell file with its model and everything that they name, in a folder of its own."""
    for path in CONFIG.glob(f"{Path(name).stem}*.toml"):
        shutil.copy(path, folder)
    for path in CONFIG.iterdir():
        if path.is_dir():
            (folder / path.name).symlink_to(path)
    return folder / name


def require_refused(cell_file: Path, robot: str, pose: str, joints_deg: list[float]) -> str:
    """What the refusal says, of a file that is as it was and alone."""
    before, beside = cell_file.read_bytes(), sorted(cell_file.parent.iterdir())
    with pytest.raises(ConfigInvalid, match="file is as it was") as refused:
        write_pose(cell_file, robot, pose, joints_deg)
    assert cell_file.read_bytes() == before
    assert sorted(cell_file.parent.iterdir()) == beside
    return refused.value.detail


def test_a_pose_beyond_the_limits_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    cell_file = copy_of("deck.toml", tmp_path)
    detail = require_refused(cell_file, "main", "home", [0.0, 0.0, 0.0, 0.0, 0.0, 999.0])
    assert "robots.main.poses_deg.home" in detail


def test_a_pose_of_which_no_daemon_but_check_finds_an_error_is_refused(tmp_path: Path) -> None:
    """A measuring pose out of the zone in which that arm measures, and a copy of another pose."""
    cell_file = copy_of("deck.toml", tmp_path)
    robots = load_cell(cell_file).robots
    beside = [*robots["aux_1"].poses_deg["retracted"]]
    beside[0] += 2.0
    detail = require_refused(cell_file, "aux_1", "measuring", beside)
    assert "zones.beside_head_1.robots.aux_1" in detail
    detail = require_refused(cell_file, "main", "deck_measure", [*robots["main"].poses_deg["home"]])
    assert "another place than home" in detail
    assert re.search(r"deck_measure = \[0\.0, .*\]$", detail), (
        "to be written by hand if it is right"
    )


def test_the_model_is_looked_for_beside_the_cell_file(tmp_path: Path) -> None:
    """Only where bases are known, a head is found to look past what it measures."""
    cell_file = copy_of("deck.toml", tmp_path)
    measuring = [*load_cell(cell_file).robots["aux_1"].poses_deg["measuring"]]
    measuring[4] += 12.0
    require_refused(cell_file, "aux_1", "measuring", measuring)
    (tmp_path / "deck.model.toml").unlink()
    write_pose(cell_file, "aux_1", "measuring", measuring)


def test_errors_that_the_file_has_already_keep_no_pose_from_being_written(tmp_path: Path) -> None:
    cell_file = copy_of("deck.toml", tmp_path)
    robots = load_cell(cell_file).robots
    text = cell_file.read_text(encoding="utf-8")
    retracted = [*robots["aux_2"].poses_deg["retracted"]]
    cell_file.write_text(with_pose(text, "aux_2", "copied", retracted), encoding="utf-8")
    before = problems_before_commissioning(cell_file)
    assert before
    taught = [*robots["aux_1"].poses_deg["measuring"]]
    write_pose(cell_file, "aux_1", "measuring", [*taught[:5], taught[5] + 0.2])
    assert problems_before_commissioning(cell_file) == before


def asked(cell_file: Path, *poses: str, answers: str) -> str:
    words = ["teach", str(cell_file), "arm", *poses]
    result = CliRunner().invoke(whole_app(), words, input=answers, catch_exceptions=False)
    return result.output


def test_a_name_that_the_file_does_not_have_is_asked_about_before_the_arm(tmp_path: Path) -> None:
    """No arm is there: whoever is asked of the name first has brought it nowhere in vain."""
    cell_file = copy_of("small.toml", tmp_path)
    before = cell_file.read_bytes()
    said = asked(cell_file, "lok", answers="n\n")
    assert "no pose 'lok'" in said
    assert "did you mean 'look'?" in said
    assert "Bring" not in said
    assert cell_file.read_bytes() == before
