"""Where the model of a cell lies that offline planning reads."""

from pathlib import Path


def model_path(cell_file: Path) -> Path:
    """``deck.model.toml`` beside ``deck.toml``."""
    return cell_file.with_suffix(".model.toml")
