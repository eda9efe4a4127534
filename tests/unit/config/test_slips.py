"""Every single slip in the figures of the shipped cell files is refused, or was decided to pass."""

from collections.abc import Callable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from cellctl.config.commissioning import examine_before_commissioning
from tests.rigs.sweeps import sweep
from tests.unit.config.passing_lists import LISTS
from tests.unit.config.passing_slips import FIGURES, Kind
from tests.unit.config.slips import SLIPS, Edit, edits
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


def judged(
    folder: Path, name: str, chosen: Callable[[Edit], bool], kinds: tuple[Kind, ...]
) -> tuple[list[str], list[str]]:
    """Edits that pass and no kind decides, and those whose remark is not what their kind says."""
    undecided, otherwise = [], []
    for edit, remarked in passing(folder, name, chosen):
        kind = kind_of(edit, kinds)
        if kind is None:
            undecided.append(f"{edit.name}: {edit.figure.text} to {edit.after}")
        elif kind.remarked not in (None, remarked):
            otherwise.append(f"{edit.name}, which is there because of: {kind.reason}")
    return undecided, otherwise


# The standard test has one slip in the file that is read quickest. The deck's moves are stated
# anew for each edit that passes, and most that pass are divided.
_QUICK = "insertion-pin.toml"
_LONG = {("deck.toml", "/10")}


def _when(name: str, slip: str) -> tuple[pytest.MarkDecorator, ...]:
    """When the sweep of a file is run: always, with the figures or before a release."""
    if name == _QUICK and slip == "x10":
        return ()
    return (pytest.mark.long if (name, slip) in _LONG else pytest.mark.figures,)


_SINGLE = [pytest.param(name, slip, marks=_when(name, slip)) for name in FILES for slip in FACTORS]


@pytest.mark.parametrize(("name", "slip"), _SINGLE)
def test_what_passes_was_decided_and_has_its_remark(tmp_path: Path, name: str, slip: str) -> None:
    def chosen(edit: Edit) -> bool:
        return edit.slip == slip and not edit.figure.listed

    assert judged(tmp_path / "cell", name, chosen, FIGURES) == ([], [])


@pytest.mark.parametrize("slip", sweep(FACTORS, ("sign",)))
def test_factors_and_signs_in_lists_were_decided(tmp_path: Path, slip: str) -> None:
    def chosen(edit: Edit) -> bool:
        return edit.slip == slip and edit.figure.listed

    assert judged(tmp_path / "cell", "insertion-pin.toml", chosen, LISTS) == ([], [])


# Every edit that passes has the drawings of plugs or decks read and held against each other, which
# takes a minute of processor time for some files. The standard test has one file whose tables,
# boxes, limits and poses are checked by the same code.
@pytest.mark.long
@pytest.mark.parametrize("slip", SLIPS)
@pytest.mark.parametrize("name", FILES)
def test_what_passes_in_lists_was_decided(tmp_path: Path, name: str, slip: str) -> None:
    def chosen(edit: Edit) -> bool:
        return edit.slip == slip and edit.figure.listed

    assert judged(tmp_path / "cell", name, chosen, LISTS) == ([], [])


def test_every_pattern_is_of_a_figure_in_a_shipped_file() -> None:
    names = {edit.name for name in FILES for edit in edits((Path("config") / name).read_text())}
    patterns = [one for kind in FIGURES + LISTS for one in kind.patterns]
    assert [one for one in patterns if not any(fnmatchcase(name, one) for name in names)] == []
