"""Shipped cell files without their recipes: no mating is planned while they are checked."""

from pathlib import Path

CONFIG = Path(__file__).parents[3] / "config"


def devices_only(tmp_path: Path, old: str = "", new: str = "", *, name: str = "deck.toml") -> Path:
    """The devices of a shipped file, with one piece of text replaced."""
    text = (CONFIG / name).read_text().split("[[recipes]]")[0]
    assert old in text
    path = tmp_path / "cell.toml"
    path.write_text(text.replace(old, new, 1))
    return path
