import builtins
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from cellctl.cli.planning.app import app
from cellctl.cli.planning.move_findings import MoveFindings
from cellctl.cli.planning.opening import open_scene
from cellctl.config import load_cell
from cellctl.config.stated.moves import StatedMove
from cellctl.errors.config import (
    ConfigInvalid,
    ConfigUnreadable,
    HeadNotDescribed,
    NoMovesStated,
    NoViewsStated,
    OutputNotWritten,
    PlaceUnreachable,
    PlanningNotInstalled,
)
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.ways import check_moves, check_zones
from cellctl.planning.ways.check_moves import CheckedMove, stated_moves
from tests.unit.planning.deck_cell import write_model

DECK = "config/deck.toml"


def run(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, words)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.exit_code, done.output


def test_show_draws_the_shipped_cell(tmp_path: Path) -> None:
    picture, glb = tmp_path / "cell.png", tmp_path / "cell.glb"
    code, _ = run("show", DECK, "--picture", str(picture), "--glb", str(glb))
    assert code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert glb.read_bytes().startswith(b"glTF")


def test_a_picture_that_cannot_be_written_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputNotWritten, match=r"cell\.png: File exists"):
        run("show", DECK, "--picture", str(tmp_path / "file" / "cell.png"))


def test_a_cell_whose_processes_state_no_moves_is_not_free(tmp_path: Path) -> None:
    text = Path("config/deck.model.toml").read_text(encoding="utf-8")
    model = tmp_path / "small.model.toml"
    model.write_text(text[: text.index("[robots.aux_1]")].replace("robots.main", "robots.arm"))
    with pytest.raises(NoMovesStated):
        run("check", "config/small.toml", "--model", str(model))


@pytest.mark.figures
def test_the_shipped_deck_cell_passes_its_own_check() -> None:
    code, output = run("check", DECK)
    assert code == 0, output


def test_what_is_free_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """With few of the moves of the shipped cell, those of each procedure among them."""

    def few(scene: CellScene) -> list[StatedMove]:
        by_procedures: dict[frozenset[int], list[StatedMove]] = {}
        for move in stated_moves(scene):
            by_procedures.setdefault(move.procedures, []).append(move)
        return [move for moves in by_procedures.values() for move in moves[:2]]

    for module in (check_moves, check_zones):
        monkeypatch.setattr(module, "stated_moves", few)
    code, output = run("check", DECK)
    assert code == 0, output
    assert "moves are free" in output
    assert "zones that keep arms apart wherever they could meet: 2" in output
    assert "stand-ins, not measured: " in output


def test_zones_that_were_not_looked_at_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Zones are held against places; an arm that does not reach them leaves nothing to hold."""
    scene = open_scene(Path(DECK), None)
    move = next(iter(stated_moves(scene)))
    unreached = CheckedMove(move, None, PlaceUnreachable("main: far"))
    monkeypatch.setattr(check_moves, "check_moves", lambda _scene: [unreached])
    findings = MoveFindings(scene)
    fault, zones = list(findings)
    assert fault.startswith("F125")
    assert zones.startswith("zones were not looked at: ")
    assert (findings.bad_moves, findings.gaps) == (1, 0)


def test_the_arms_of_both_shipped_deck_cells_go_the_same_ways() -> None:
    one, other = (load_cell(Path(name)) for name in (DECK, "config/deck-jobs.toml"))
    assert one.robots["main"].ways
    for name, robot in one.robots.items():
        assert robot.ways == other.robots[name].ways
        assert robot.poses_deg == other.robots[name].poses_deg


@pytest.mark.long
def test_check_names_the_moves_that_are_not_free(tmp_path: Path) -> None:
    text = Path(DECK).read_text(encoding="utf-8")
    cell = tmp_path / "deck.toml"
    cell.write_text(text.replace("[0.0, -90.0, 120.0,", "[0.0, -88.0, 90.0,"))
    for folder in ("features", "demo-calibration"):
        (tmp_path / folder).symlink_to((Path(DECK).parent / folder).resolve())
    code, output = run("check", str(cell), "--model", "config/deck.model.toml")
    assert code == 1
    assert "main: home to deck_measure (joint): main.deck and aux_2.forearm" in output


@pytest.mark.long
def test_paths_are_written_and_then_free(tmp_path: Path) -> None:
    out = tmp_path / "deck.toml"
    for folder in ("features", "demo-calibration"):
        (tmp_path / folder).symlink_to((Path(DECK).parent / folder).resolve())
    _, output = run("paths", DECK, "--out", str(out))
    assert "main: home to deck_measure and back" in output
    assert out.read_text(encoding="utf-8").count("[[robots.main.ways]]") == 2
    _, output = run("check", str(out), "--model", "config/deck.model.toml")
    assert "main: home to deck_measure" not in output


def test_a_bad_model_leaves_no_file(tmp_path: Path) -> None:
    out = tmp_path / "deck.toml"
    missing = str(tmp_path / "none.model.toml")
    with pytest.raises(ConfigUnreadable):
        run("paths", DECK, "--model", missing, "--out", str(out))
    assert list(tmp_path.iterdir()) == []


def test_a_model_of_another_place_of_the_frame_is_refused(tmp_path: Path) -> None:
    model = write_model(tmp_path, "[1900.0, 0.0, 390.0", "[1900.0, 0.0, 290.0")
    with pytest.raises(ConfigInvalid, match=r"fixtures\.frame = .* ends 100 mm below it"):
        run("check", DECK, "--model", str(model))


def test_without_the_extra_the_fault_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *args: Any, **kwargs: Any) -> Any:
        if name.startswith("cellctl.planning"):
            raise ImportError("No module named 'fcl'")
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(PlanningNotInstalled, match="fcl"):
        open_scene(Path(DECK), None)


@pytest.mark.long  # a search in all directions: half a minute on a free core
def test_viewpoints_are_planned_and_written(tmp_path: Path) -> None:
    out = tmp_path / "deck.toml"
    code, output = run("viewpoints", DECK, "--out", str(out))
    assert code == 0
    assert "planned: sigma" in output
    assert "with other equipment:" in output
    changed = set(out.read_text().splitlines()) - set(Path(DECK).read_text().splitlines())
    assert len(changed) == 2


def test_viewpoints_of_a_cell_without_stated_measurements_are_refused(tmp_path: Path) -> None:
    text = Path("config/deck.model.toml").read_text(encoding="utf-8")
    model, out = tmp_path / "pin.model.toml", tmp_path / "pin.toml"
    model.write_text(text[: text.index("[robots.aux_1]")].replace("robots.main", "robots.arm"))
    with pytest.raises(NoViewsStated):
        run("viewpoints", "config/insertion-pin.toml", "--model", str(model), "--out", str(out))
    assert not out.exists()


def test_a_head_without_its_section_leaves_no_file(tmp_path: Path) -> None:
    text = Path("config/deck.model.toml").read_text(encoding="utf-8")
    model, out = tmp_path / "deck.model.toml", tmp_path / "deck.toml"
    start, end = text.index("[stereo_cameras.head_2]"), text.index("[fixtures]")
    model.write_text(text[:start] + text[end:])
    with pytest.raises(HeadNotDescribed, match="head_2"):
        run("viewpoints", DECK, "--model", str(model), "--out", str(out))
    assert not out.exists()
