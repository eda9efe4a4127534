"""What `cellctl check` says to the mistakes of a first week: line, key, value, what is allowed."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.config import problems_before_commissioning
from cellctl.config.commissioning import examine_before_commissioning
from tests.rigs.sweeps import sweep
from tests.unit.config.between_arms import BETWEEN_ARMS
from tests.unit.config.deck_week import DECK_WEEK, DECK_WEEK_PASSES
from tests.unit.config.fresh_cells import FRESH_CELLS, FRESH_CELLS_PASS
from tests.unit.config.fresh_eyes import FRESH_EYES, FRESH_EYES_PASSES
from tests.unit.config.images_and_drawings import (
    IMAGES_AND_DRAWINGS,
    IMAGES_AND_DRAWINGS_PASS,
)
from tests.unit.config.mistake import Mistake, Undecided
from tests.unit.config.mistakes import MISTAKES
from tests.unit.config.passed_before import PASSED_BEFORE, PASSES_WITH_REMARK
from tests.unit.config.protective_mistakes import PROTECTIVE
from tests.unit.config.second_look_figures import FIGURES, OTHERS
from tests.unit.config.second_look_places import PLACES
from tests.unit.config.single_figures import SINGLE_FIGURES
from tests.unit.config.third_day import IN_CELL_FILES, IN_DRAWINGS
from tests.unit.config.touching_cells import MEANT_PERHAPS, TOUCHING_CELLS
from tests.unit.config.undecided import UNDECIDED

CONFIG = Path(__file__).parents[3] / "config"
FAKE_CELLS = sorted(path.name.replace(".scenario", "") for path in CONFIG.glob("*.scenario.toml"))


def written(
    folder: Path, name: str, old: str = "", new: str = "", features: tuple[str, ...] = ()
) -> Path:
    """A shipped cell file beside the files that it names, with one mistake in it or in these
    feature files."""
    text = (CONFIG / name).read_text()
    folder.mkdir(exist_ok=True)
    for other in CONFIG.iterdir():
        if (other.is_dir() and other.name != "features") or other.name.endswith(".model.toml"):
            (folder / other.name).symlink_to(other)
    shutil.copytree(CONFIG / "features", folder / "features")
    path = folder / name
    path.write_text(text)
    for changed in [folder / "features" / file for file in features] or [path]:
        before = changed.read_text()
        assert old in before
        changed.write_text(before.replace(old, new, 1))
    return path


SECOND_LOOK = PLACES + FIGURES + OTHERS
THIRD_DAY = IN_CELL_FILES + IN_DRAWINGS
ALL = (
    *(MISTAKES + SECOND_LOOK + THIRD_DAY + PROTECTIVE + SINGLE_FIGURES + BETWEEN_ARMS),
    *(TOUCHING_CELLS + PASSED_BEFORE + FRESH_EYES + FRESH_CELLS + DECK_WEEK + IMAGES_AND_DRAWINGS),
)


def test_there_are_more_than_sixty_half_by_somebody_else_and_all_differ() -> None:
    assert len({(one.file, one.old, one.new, one.features) for one in ALL}) == len(ALL)
    assert len(MISTAKES) >= 50
    assert len(SECOND_LOOK) >= 50
    assert len(THIRD_DAY) >= 40


def of_each_key(mistakes: Sequence[Mistake]) -> tuple[Mistake, ...]:
    """The first mistake in each key of any table: what is typical of its checks."""
    return tuple({one.key.rpartition(".")[2]: one for one in reversed(mistakes)}.values())


@pytest.mark.parametrize(
    "mistake", sweep(ALL, of_each_key(ALL)), ids=lambda one: f"{one.file}-{one.key}"
)
def test_a_mistake_is_refused_where_it_stands(tmp_path: Path, mistake: Mistake) -> None:
    path = written(tmp_path, mistake.file, mistake.old, mistake.new, mistake.features)
    found = problems_before_commissioning(path)
    matching = [one for one in found if one.key == mistake.key and mistake.said in one.allowed]
    assert matching, found
    if mistake.features:
        assert matching[0].allowed.startswith("line ") or "lists" in matching[0].allowed
        return  # its line is that of the key which names the file
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


PASSING = (
    *(UNDECIDED + MEANT_PERHAPS + PASSES_WITH_REMARK + FRESH_EYES_PASSES),
    *(FRESH_CELLS_PASS + DECK_WEEK_PASSES + IMAGES_AND_DRAWINGS_PASS),
)
PASSING_KEYS = of_each_key([one.mistake for one in PASSING])


@pytest.mark.parametrize(
    "case",
    sweep(PASSING, [one for one in PASSING[::3] if one.mistake in PASSING_KEYS]),
    ids=lambda one: one.reason,
)
def test_what_nobody_can_decide_passes_with_a_remark_where_there_is_one(
    tmp_path: Path, case: Undecided
) -> None:
    slip = case.mistake
    path = written(tmp_path, slip.file, slip.old, slip.new, slip.features)
    examined = examine_before_commissioning(path)
    assert examined.errors == ()
    if slip.said:
        (remark,) = [one for one in examined.remarks if one.key == slip.key]
        assert slip.said in remark.allowed
        assert remark.line is not None
        path.write_text(path.read_text().replace("FILL IN", "found"))
        done = CliRunner().invoke(whole_app(), ["check", str(path), "--json"])
        assert done.exit_code == 0
        assert slip.key in {one["key"] for one in json.loads(done.stdout)["remarks"]}


def test_what_only_the_first_touch_shows_is_said() -> None:
    for name, said in (("insertion-connector.toml", True), ("insertion-pin.toml", False)):
        done = CliRunner().invoke(whole_app(), ["check", str(CONFIG / name), "--json"])
        assert (
            any("datum_depth_mm" in one for one in json.loads(done.stdout)["not_checked_yet"])
            is said
        )


def test_shipped_cell_files_have_no_remarks() -> None:
    for name in (*FAKE_CELLS, "cell.toml", "deck-gige.toml", "antenna-gige.toml"):
        assert examine_before_commissioning(CONFIG / name).remarks == (), name


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


@pytest.mark.parametrize("name", FAKE_CELLS)
def test_the_cell_file_of_every_scenario_is_good(name: str) -> None:
    assert problems_before_commissioning(CONFIG / name) == []
