"""Every single slip in the figures of the shipped cell files is refused, or was decided to pass."""

from collections.abc import Callable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from cellctl.config.commissioning import examine_before_commissioning
from tests.unit.config.passing_slips import FIGURES, Kind
from tests.unit.config.slips import Edit, edits
from tests.unit.config.test_mistakes import written

FILES = ("deck.toml", "antenna.toml", "insertion-pin.toml", "insertion-connector.toml")
FACTORS = ("x10", "/10", "sign")
"""The slips of single figures: ten more or less of one is either small or a factor as well."""


def passing(folder: Path, name: str, chosen: Callable[[Edit], bool]) -> Iterator[tuple[Edit, bool]]:
    """Those of the chosen edits of a file that are called good, and whether with a remark."""
    path = written(folder, name)
    text = path.read_text()
    for edit in edits(text):
        if not chosen(edit):
            continue
        path.write_text(edit.of(text))
        examined = examine_before_commissioning(path)
        if not examined.errors:
            yield edit, bool(examined.remarks)


def kind_of(edit: Edit, kinds: tuple[Kind, ...]) -> Kind | None:
    """The first kind that decides an edit."""
    for kind in kinds:
        if any(fnmatchcase(edit.name, one) for one in kind.patterns):
            return kind
    return None


@pytest.mark.parametrize("slip", FACTORS)
@pytest.mark.parametrize("name", FILES)
def test_what_passes_was_decided_and_has_its_remark(tmp_path: Path, name: str, slip: str) -> None:
    undecided, silent = [], []

    def chosen(edit: Edit) -> bool:
        return edit.slip == slip and not edit.figure.listed

    for edit, remarked in passing(tmp_path / "cell", name, chosen):
        kind = kind_of(edit, FIGURES)
        if kind is None:
            undecided.append(f"{edit.name}: {edit.figure.text} to {edit.after}")
        elif kind.remarked != remarked:
            silent.append(edit.name)
    assert undecided == []
    assert silent == []


def test_every_pattern_is_of_a_figure_in_a_shipped_file() -> None:
    names = {edit.name for name in FILES for edit in edits((Path("config") / name).read_text())}
    patterns = [one for kind in FIGURES for one in kind.patterns]
    assert [one for one in patterns if not any(fnmatchcase(name, one) for name in names)] == []
