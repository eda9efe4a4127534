"""Which way the images of a demonstration take, and the cell file for the one through GenTL."""

import shutil
from pathlib import Path
from typing import Any

import pytest

from cellctl.config.load import load_cell
from fakes.demo import gentl
from fakes.demo.gentl import GentlPath, UnusualCellFile, way_of_images
from fakes.gentl.build import NAME, NoCompilerError
from fakes.scenario_file.scenario import Scenario
from fakes.scenes.load import load as load_scenario

CONFIG = Path(__file__).parents[4] / "config"


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    """The producer is not compiled; options of the compiler that were asked for."""
    asked: list[tuple[str, ...]] = []

    def build(folder: Path, *options: str) -> Path:
        asked.append(options)
        return folder / NAME

    monkeypatch.setattr(gentl, "build_producer", build)
    return asked


@pytest.fixture
def without_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fakes.gentl.build.shutil.which", lambda _name: None)


def deck() -> Scenario:
    return load_scenario(CONFIG / "deck.scenario.toml")


def through_gentl(cell: Path, load: Any, folder: Path) -> GentlPath:
    path, said = way_of_images(None, cell, load, folder)
    assert path is not None
    assert "GenTL" in said
    return path


def test_heads_are_pairs_of_gige_cameras(tmp_path: Path, built: list[tuple[str, ...]]) -> None:
    """All else is as in the cell file, and what lies beside that is found: recipes are read."""
    path = through_gentl(CONFIG / "deck.toml", deck, tmp_path / "gentl")
    assert built == [(f'-DSTATE_FILE="{path.cameras}"',)]
    there, before = load_cell(path.cell), load_cell(CONFIG / "deck.toml")
    head = there.stereo_cameras["head_1"]
    assert (head.driver, head.simulated) == ("gige", True)
    assert head.settings["left"] == {"serial_number": "FH-0001L"}
    assert head.settings["right"] == {"serial_number": "FH-0001R"}
    assert head.settings["producers"] == [str(tmp_path / "gentl" / NAME)]
    assert head.settings["exposure_s"] == pytest.approx(0.008)
    assert there.model_copy(update={"stereo_cameras": before.stereo_cameras}) == before
    changed, shipped = (
        file.read_text(encoding="utf-8").splitlines() for file in (path.cell, CONFIG / "deck.toml")
    )
    differ = [line for line, was in zip(changed, shipped, strict=True) if line != was]
    assert len(differ) == 4, "driver and settings of two heads; all else keeps its line"
    before_head = before.stereo_cameras["head_1"]
    same = {"driver": before_head.driver, "settings": before_head.settings}
    assert head.model_copy(update=same) == before_head


def test_single_cameras_too(tmp_path: Path, built: list[tuple[str, ...]]) -> None:
    def load() -> Scenario:
        return load_scenario(CONFIG / "antenna.scenario.toml")

    path = through_gentl(CONFIG / "antenna.toml", load, tmp_path / "gentl")
    eye = load_cell(path.cell).cameras["camera_1"]
    assert eye.driver == "gige"
    assert eye.settings["camera"] == {"serial_number": "FC-0011"}
    assert eye.settings["pixel_format"] == "RGB8"


def test_a_second_time_in_the_same_folder(tmp_path: Path, built: list[tuple[str, ...]]) -> None:
    first = through_gentl(CONFIG / "deck.toml", deck, tmp_path / "gentl")
    assert through_gentl(CONFIG / "deck.toml", deck, tmp_path / "gentl") == first


def test_a_folder_beside_the_cell_file_has_no_link_to_itself(
    tmp_path: Path, built: list[tuple[str, ...]]
) -> None:
    cell = Path(shutil.copy(CONFIG / "deck.toml", tmp_path / "cell.toml"))
    (tmp_path / "features").mkdir()
    (tmp_path / "run").mkdir()
    path = through_gentl(cell, deck, tmp_path / "run" / "gentl")
    links = {link.name for link in path.cell.parent.iterdir() if link.is_symlink()}
    assert links == {"features"}


def test_a_cell_file_that_is_written_otherwise_keeps_its_frame_servers(tmp_path: Path) -> None:
    text = (CONFIG / "deck.toml").read_text(encoding="utf-8")
    settings = "settings = { host"
    cell = tmp_path / "cell.toml"
    cell.write_text(text.replace(settings, "settings.port = 1\nsettings.x = { host", 1))
    path, said = way_of_images(None, cell, deck, tmp_path / "gentl")
    assert path is None
    assert "does not have driver and settings of each camera in one line" in said
    with pytest.raises(UnusualCellFile):
        way_of_images("gentl", cell, deck, tmp_path / "gentl")


def test_without_a_compiler_it_says_that_frame_servers_stand_in(
    tmp_path: Path, without_compiler: None
) -> None:
    path, said = way_of_images(None, CONFIG / "deck.toml", deck, tmp_path / "gentl")
    assert path is None
    assert said == (
        "no C compiler (cc) on this machine: images come from frame servers, not through GenTL"
    )


def test_without_a_compiler_the_wish_is_refused(tmp_path: Path, without_compiler: None) -> None:
    with pytest.raises(NoCompilerError, match="no C compiler"):
        way_of_images("gentl", CONFIG / "deck.toml", deck, tmp_path / "gentl")


def test_heads_with_one_number_keep_it_and_their_calibrations(
    tmp_path: Path, built: list[tuple[str, ...]]
) -> None:
    def load() -> Scenario:
        heads = {
            name: head.model_copy(update={"serial": "FH-7"})
            for name, head in deck().stereo_cameras.items()
        }
        return deck().model_copy(update={"stereo_cameras": heads})

    path, said = way_of_images(None, CONFIG / "deck.toml", load, tmp_path / "gentl")
    assert path is None
    assert said.startswith("head_1 has one serial number")
    path, _ = way_of_images("gentl", CONFIG / "deck.toml", load, tmp_path / "gentl")
    assert path is not None
    assert "FH-7L" in path.cell.read_text(encoding="utf-8")


def test_frame_servers_are_had_for_the_asking(tmp_path: Path) -> None:
    path, said = way_of_images("frame-server", CONFIG / "deck.toml", deck, tmp_path / "gentl")
    assert path is None
    assert said == "images come from frame servers"
    assert not (tmp_path / "gentl").exists()


@pytest.mark.parametrize("cell", ["insertion-pin.toml", "no-such.toml", "cell.toml"])
def test_nothing_is_said_of_a_cell_without_fake_cameras(tmp_path: Path, cell: str) -> None:
    assert way_of_images(None, CONFIG / cell, deck, tmp_path / "gentl") == (None, "")
