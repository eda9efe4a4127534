"""A file beside the cell file is named as what it is, and not checked key by key."""

from pathlib import Path

import pytest

from cellctl.config import problems
from cellctl.errors.config import ConfigUnreadable

CONFIG = Path(__file__).parents[4] / "config"


@pytest.mark.parametrize("path", sorted(CONFIG.glob("*.scenario.toml")), ids=lambda path: path.name)
def test_a_scenario_is_no_cell_file(path: Path) -> None:
    with pytest.raises(ConfigUnreadable, match="the scenario of a fake cell"):
        problems(path)


@pytest.mark.parametrize("path", sorted(CONFIG.glob("*.model.toml")), ids=lambda path: path.name)
def test_a_model_is_no_cell_file(path: Path) -> None:
    with pytest.raises(ConfigUnreadable, match="the model of a cell"):
        problems(path)
