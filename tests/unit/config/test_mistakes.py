"""What `cellctl check` says to the mistakes of a first week: line, key, value, what is allowed."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import problems_before_commissioning
from tests.unit.config.mistake import Mistake
from tests.unit.config.mistakes import MISTAKES
from tests.unit.config.second_look_figures import FIGURES, OTHERS
from tests.unit.config.second_look_places import PLACES

CONFIG = Path(__file__).parents[3] / "config"


def written(folder: Path, name: str, old: str = "", new: str = "") -> Path:
    """A shipped cell file with one mistake in it, beside the files that it names."""
    text = (CONFIG / name).read_text()
    assert old in text
    folder.mkdir(exist_ok=True)
    for other in CONFIG.iterdir():
        if other.is_dir():
            (folder / other.name).symlink_to(other)
    path = folder / name
    path.write_text(text.replace(old, new, 1) if old else text)
    return path


SECOND_LOOK = PLACES + FIGURES + OTHERS
ALL = MISTAKES + SECOND_LOOK


def test_there_are_more_than_sixty_half_by_somebody_else_and_all_differ() -> None:
    assert len({(one.file, one.old, one.new) for one in ALL}) == len(ALL)
    assert len(MISTAKES) >= 50
    assert len(SECOND_LOOK) >= 50


@pytest.mark.parametrize("mistake", ALL, ids=lambda one: f"{one.file}-{one.key}")
def test_a_mistake_is_refused_where_it_stands(tmp_path: Path, mistake: Mistake) -> None:
    path = written(tmp_path, mistake.file, mistake.old, mistake.new)
    found = problems_before_commissioning(path)
    matching = [one for one in found if one.key == mistake.key and mistake.said in one.allowed]
    assert matching, found
    original = (CONFIG / mistake.file).read_text()
    first = original.split(mistake.old, 1)[0].count("\n") + 1
    last = first + mistake.new.count("\n")
    # A key that is missing has the line of its table, and so has what is wrong with all of it.
    whole = (
        mistake.at_the_other
        or matching[0].value == "(missing)"
        or matching[0].key.endswith(".settings")
    )
    if matching[0].key != "simulated":  # of all devices
        assert matching[0].line is not None
        assert whole or first <= matching[0].line <= last
    assert all(one.line is not None or one.key == "simulated" for one in found)


def test_check_prints_line_key_value_and_what_is_allowed(tmp_path: Path) -> None:
    path = written(tmp_path, "deck.toml", "speed_percent = 40", 'speed_percent = "40"')
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 1
    assert "F102 line 14: robots.main.speed_percent = '40'" in done.output
    assert "allowed: 1 to 100" in done.output


@pytest.mark.parametrize("name", ["cell.toml", "deck-gige.toml", "antenna-gige.toml"])
def test_a_template_is_not_good_as_it_is(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, name)
    done = CliRunner().invoke(whole_app(), ["check", str(path)])
    assert done.exit_code == 1
    assert "line 8:" in done.output or "line 9:" in done.output
    assert "FILL IN" in done.output
    path.write_text(path.read_text().replace("FILL IN", "found"))
    assert CliRunner().invoke(whole_app(), ["check", str(path)]).exit_code == 0


@pytest.mark.parametrize("name", sorted(path.name for path in CONFIG.glob("*.scenario.toml")))
def test_the_cell_file_of_every_scenario_is_good(name: str) -> None:
    assert problems_before_commissioning(CONFIG / name.replace(".scenario", "")) == []
