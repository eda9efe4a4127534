"""`cellctl keys`: the reference of the cell file, and single keys in words."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.cli.commissioning.keys import key_page

DOCS = Path(__file__).parents[4] / "docs"


def told(*arguments: str) -> str:
    done = CliRunner().invoke(whole_app(), ["keys", *arguments])
    assert done.exit_code == 0, done.output
    return done.output


def test_the_page_is_that_of_the_models() -> None:
    assert told() == key_page() == (DOCS / "cell-file.md").read_text(encoding="utf-8"), (
        "cellctl keys > docs/cell-file.md"
    )


def test_a_key_is_told_with_its_place_bounds_default_and_meaning() -> None:
    words = told("panel_shift")
    assert words.splitlines()[0] == "panel_shift_mm  [processes.peg-in-hole], peg-in-hole"
    assert "number, more than 0 to 5; default: 0.3" in words
    assert "procedure 302" in words


def test_a_key_of_two_processes_is_told_for_both() -> None:
    places = re.findall(r"^stand_off_mm  (.*)$", told("stand_off_mm"), re.MULTILINE)
    assert places == ["[recipes.insertion], antenna-module", "[[recipes]], deck-to-frame"]


@pytest.mark.parametrize("word", ["stand_of_mm", "nonsense"])
def test_a_word_that_no_key_has_is_refused(word: str) -> None:
    done = CliRunner().invoke(whole_app(), ["keys", word])
    assert done.exit_code == 2
    assert ("did you mean 'stand_off_mm'?" in done.output) == (word == "stand_of_mm")
