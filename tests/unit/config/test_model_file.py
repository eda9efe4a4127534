"""Where the model of a cell says that its arms stand."""

from pathlib import Path

import pytest

from cellctl.config.model_file import model_path, stated_bases
from tests.unit.config.test_mistakes import CONFIG


def test_the_bases_of_a_model_are_read() -> None:
    bases = stated_bases(CONFIG / "deck.toml")
    assert bases["main"] == (0.0,) * 6
    assert bases["aux_1"] == (1900.0, -2300.0, 0.0, 90.0, 0.0, 0.0)


@pytest.mark.parametrize("text", ["[robots", "robots = 3", "[robots.main]\ncell_T_base = [1.0]"])
def test_a_model_that_planning_refuses_says_nothing(tmp_path: Path, text: str) -> None:
    model_path(tmp_path / "cell.toml").write_text(text)
    assert stated_bases(tmp_path / "cell.toml") == {}


def test_a_cell_without_a_model_has_no_stated_bases() -> None:
    assert stated_bases(CONFIG / "small.toml") == {}
