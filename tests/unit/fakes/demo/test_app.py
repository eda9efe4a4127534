"""What the demonstration refuses before it starts a process: mostly one sentence and code 1."""

import socket
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fakes.demo import registry
from fakes.demo.app import app
from fakes.demo.demo import Evidence, Judgement
from fakes.demo.processes.deck_to_frame import DeckToFrameDemo
from tests.rigs.whole_cell.own_cell import OwnCell

CONFIG = Path(__file__).parents[4] / "config"


def refused(*arguments: str) -> str:
    done = CliRunner().invoke(app, list(arguments))
    assert done.exit_code == 1, done.output
    assert len(done.stderr.splitlines()) == 1
    return done.stderr


@pytest.fixture
def taken() -> Iterator[int]:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        yield int(server.getsockname()[1])


def test_an_unknown_process_names_those_that_there_are() -> None:
    assert (
        "there is no demonstration of 'weaving'; there are: antenna-module, deck-to-frame, "
        "peg-in-hole" in refused("--process", "weaving")
    )


def test_a_shipped_cell_is_known_by_its_short_name(tmp_path: Path, taken: int) -> None:
    demo = registry.find("peg-in-hole")
    assert sorted(demo.cells) == ["connector", "pin", "pin-rpc"]
    for cell in demo.cells.values():
        assert cell.is_file()
        assert cell.with_suffix(".scenario.toml").is_file()
    asked = ("--process", "peg-in-hole", "--cell", "pin", "--out", str(tmp_path / "out"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(demo), "cells", {"pin": _on_a_taken_port(tmp_path, taken)})
        assert f"port {taken}" in refused(*asked)


def test_a_name_that_no_cell_has_is_told_with_those_that_there_are() -> None:
    told = refused("--process", "peg-in-hole", "--cell", "pni")
    assert "no cell file pni; peg-in-hole has connector, pin, pin-rpc" in told
    assert "--process peg-in-hole has 'pin'" in refused("--cell", "pin")


def test_the_cell_file_of_another_process_starts_nothing(tmp_path: Path) -> None:
    file, out = str(CONFIG / "insertion-pin.toml"), tmp_path / "out"
    told = refused("--process", "antenna-module", "--cell", file, "--out", str(out))
    assert "is of the process peg-in-hole: name that by --process" in told
    assert not out.exists()


def _on_a_taken_port(folder: Path, taken: int) -> Path:
    """Refused for its port: so it is this file that was read."""
    text = (CONFIG / "insertion-pin.toml").read_text(encoding="utf-8")
    scenario = (CONFIG / "insertion-pin.scenario.toml").read_text(encoding="utf-8")
    (folder / "mine.scenario.toml").write_text(scenario.replace("7950", str(taken)))
    cell = folder / "mine.toml"
    cell.write_text(text)
    return cell


def test_a_real_cell_is_refused(tmp_path: Path) -> None:
    said = refused("--cell", str(CONFIG / "cell.toml"), "--out", str(tmp_path / "out"))
    assert "is the cell file of a real cell" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("port", "name"),
    [(7900, "control"), (7101, "head_1"), (7003, "main.GRD"), (5020, "Modbus TCP of the daemon")],
)
def test_an_occupied_port_is_named_with_what_to_do(
    tmp_path: Path, taken: int, port: int, name: str
) -> None:
    own = OwnCell.make(tmp_path)  # on ports that no other cell on this computer has
    for file in (own.scenario, own.cell):
        file.write_text(file.read_text().replace(f" = {own.ports[port]}", f" = {taken}"))
    files = ("--scenario", str(own.scenario), "--cell", str(own.cell))
    said = refused(*files, "--out", str(tmp_path / "out"))
    assert f"port {taken} ({name}) is in use" in said
    assert "end that one" in said
    assert "Errno" not in said
    assert not (tmp_path / "out").exists()


def test_a_way_of_the_images_that_cannot_be_built_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fakes.gentl.build.shutil.which", lambda _name: None)
    own = OwnCell.make(tmp_path)
    files = ("--scenario", str(own.scenario), "--cell", str(own.cell))
    said = refused(*files, "--out", str(tmp_path / "out"), "--cameras", "gentl")
    assert said == "no C compiler (cc) on this machine\n"


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("silent", "'silent' is no device:name; the devices are main, aux_1, aux_2,"),
        ("head_3:silent", "the devices are main, aux_1, aux_2,"),
        ("main:slient", "main knows no fault 'slient'; it knows abort, automatic_mode,"),
        ("world:rain", "world knows no fault 'rain'"),
    ],
)
def test_an_unknown_fault_starts_nothing(tmp_path: Path, fault: str, said: str) -> None:
    out = tmp_path / "out"
    done = CliRunner().invoke(app, ["--fault", fault, "--out", str(out)])
    assert done.exit_code == 2
    assert said in " ".join(done.stderr.split())
    assert not out.exists()


def test_an_unknown_scene_names_those_that_there_are(tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.toml"
    scenario.write_text('scene = "moon"\n')
    assert "known scenes: antenna-bench, deck-on-frame, plate" in refused(
        "--scenario", str(scenario)
    )


class WeavingDemo(DeckToFrameDemo):
    """A demonstration of another package."""

    process = "weaving"

    def judge(self, evidence: Evidence) -> Judgement:
        """Everything is good."""
        return Judgement(evidence.good)


def test_another_package_brings_a_demonstration(monkeypatch: pytest.MonkeyPatch) -> None:
    def points(**_: str) -> list[EntryPoint]:
        return [EntryPoint("weaving", f"{__name__}:WeavingDemo", registry.GROUP)]

    monkeypatch.setattr(registry, "entry_points", points)
    assert registry.demonstrated() == ["weaving"]
    assert registry.find("weaving").judge(Evidence({"result": "good"}, {}, {})).passed


def test_what_is_no_demo_is_no_demo(monkeypatch: pytest.MonkeyPatch) -> None:
    def points(**_: str) -> list[EntryPoint]:
        return [EntryPoint("weaving", "pathlib:Path", registry.GROUP)]

    monkeypatch.setattr(registry, "entry_points", points)
    with pytest.raises(registry.UnknownProcess, match="is not a Demo"):
        registry.find("weaving")
