"""The shipped cell with its model, for the tests of planning."""

from functools import cache
from pathlib import Path

from cellctl.config.model_file import model_path
from cellctl.planning.model.read import read_model
from cellctl.planning.scene.cell_scene import CellScene
from tests.rigs.shipped import shipped_cell

DECK = Path("config/deck.toml")


@cache
def deck_scene() -> CellScene:
    return read_model(shipped_cell(DECK.name), model_path(DECK), DECK.parent)


def write_model(folder: Path, old: str, new: str) -> Path:
    """The shipped model with one text replaced."""
    text = model_path(DECK).read_text(encoding="utf-8")
    assert old in text
    path = folder / "deck.model.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path
