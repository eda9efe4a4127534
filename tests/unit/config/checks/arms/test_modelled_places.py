"""Stations of the shipped cells that their model has elsewhere, or not at all."""

from pathlib import Path

import pytest

from cellctl.config.commissioning import model_issues
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import stated_model
from tests.rigs.shipped import shipped_cell

CONFIG = Path(__file__).parents[5] / "config"
HOLE, SOCKET = "recipes.0.base_T_hole.pose", "recipes.0.base_T_socket.pose"
PLATE = "processes.antenna-module.reference.base_T_plate.pose"
PART = """part = { box = { size_mm = [120.0, 120.0, 200.0], at = [500.0, -200.0, 100.0, 0.0, 0.0, 0.0] }, stand_in = true }
"""  # noqa: E501


def found(folder: Path, cell: str, old: str = "", new: str = "") -> list[ConfigIssue]:
    """What a shipped cell file has against its model with this replacement."""
    text = (CONFIG / f"{cell}.model.toml").read_text(encoding="utf-8")
    assert old in text
    model = folder / f"{cell}.model.toml"
    model.write_text(text.replace(old, new, 1), encoding="utf-8")
    return list(model_issues(shipped_cell(f"{cell}.toml"), stated_model(model)))


@pytest.mark.parametrize("cell", ["antenna", "insertion-pin", "insertion-connector"])
def test_the_shipped_models_have_every_station(tmp_path: Path, cell: str) -> None:
    assert found(tmp_path, cell) == []


@pytest.mark.parametrize(
    ("cell", "old", "new", "key", "said"),
    [
        ("insertion-pin", PART, "", HOLE, "; table is nearest, 200 mm away"),
        (
            "insertion-pin",
            "[500.0, -200.0, 100",
            "[500.0, 100.0, 100",
            HOLE,
            "table is nearest, 200",
        ),
        ("insertion-pin", "[120.0, 120.0, 200.0]", "[120.0, 120.0, 20.0]", HOLE, "90 mm away"),
        (
            "antenna",
            "[500.0, -200.0, 100.0",
            "[500.0, 200.0, 100.0",
            SOCKET,
            "table is nearest, 200",
        ),
        ("antenna", "[500.0, 112.5, 288.5", "[500.0, 112.5, 208.5", PLATE, "plate is nearest, 80"),
    ],
)
def test_a_station_that_no_body_has_is_named(
    tmp_path: Path, cell: str, old: str, new: str, key: str, said: str
) -> None:
    """Every way to it would be called free."""
    (issue,) = found(tmp_path, cell, old, new)
    assert issue.key == key
    assert said in issue.allowed


def test_nothing_is_said_of_a_model_with_other_shapes(tmp_path: Path) -> None:
    old = "part = { box = { size_mm = [120.0, 120.0, 200.0], at = [500.0, -200.0, 100.0, "
    new = 'part = { mesh = { file = "part.stl", at = [500.0, -200.0, 100.0, '
    assert found(tmp_path, "insertion-pin", old, new) == []
