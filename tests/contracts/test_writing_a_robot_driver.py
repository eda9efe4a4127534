"""docs/writing-a-robot-driver.md is true: the package that it describes passes both contracts, and
this repository's own tests pass beside it.
"""

from pathlib import Path

import pytest

from tests.guides.beta_mutations import MUTATIONS, Mutation
from tests.guides.package import (
    ROOT,
    contract_by_hand,
    contract_of,
    guide_package,
    registry_beside,
    style_of,
    write_files,
)

GUIDE = ROOT / "docs" / "writing-a-robot-driver.md"
FOLDER = {"README.md", "config.py", "protocol.py", "connection.py", "driver.py", "faults.py"}


written, installed = guide_package(GUIDE, "cellctl-beta")


def test_the_folder_is_complete(written: Path) -> None:
    assert {path.name for path in (written / "beta_r6").iterdir()} >= FOLDER


def test_both_contracts_hold_as_the_page_runs_them(written: Path, installed: Path) -> None:
    done = contract_by_hand(GUIDE, written, installed)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def changed(path: Path, *changes: tuple[str, str]) -> None:
    """Replace texts of a file that the guide has."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def assert_refused(folder: Path, *clauses: str, only: str = "") -> None:
    done = contract_of(folder, folder, only)
    assert done.returncode == 1
    for clause in clauses:
        assert f"::{clause}" in done.stdout, done.stdout


@pytest.mark.figures  # the contract run once more, which only finds other errors then
def test_a_driver_that_forgets_a_duty_does_not_pass(tmp_path: Path) -> None:
    """The contract finds what the page warns of: a bound and a stop that are missing, and the
    matrix of the guard's port read by columns."""
    write_files(GUIDE, tmp_path)
    bound = "        self._bounds.step(self.state(), base_T_flange)\n"
    stop = "            await self.stop()\n            raise\n"
    changed(tmp_path / "beta_r6" / "driver.py", (bound, ""), (stop, "            raise\n"))
    by_columns = ("        tuple(rotation),\n", "        tuple(matrix.T.ravel().tolist()),\n")
    changed(tmp_path / "beta_r6" / "protocol.py", by_columns)
    assert_refused(
        tmp_path,
        "test_targets_are_bounded",
        "test_cancellation_stops_first",
        "test_reports_are_fresh_and_well_formed",
    )


@pytest.mark.long
@pytest.mark.parametrize("mutation", MUTATIONS, ids=[one.error for one in MUTATIONS])
def test_an_error_that_authors_make_is_found(tmp_path: Path, mutation: Mutation) -> None:
    write_files(GUIDE, tmp_path)
    changed(tmp_path / "beta_r6" / mutation.file, (mutation.old, mutation.new))
    assert_refused(tmp_path, mutation.clause, only=mutation.clause)


def test_every_clause_that_finds_an_error_is_named_on_the_page() -> None:
    text = GUIDE.read_text(encoding="utf-8")
    assert [one.clause for one in MUTATIONS if f"`{one.clause}`" not in text] == []


@pytest.mark.figures  # collects tests of this project once more, which a driver rarely upsets
def test_our_own_tests_pass_beside_it(installed: Path) -> None:
    done = registry_beside(installed)
    assert done.returncode == 0, done.stdout + done.stderr
    for group in ("cellctl.robot", "cellctl.stop_channel"):
        assert f"test_implements_its_interface[{group}:beta-r6] PASSED" in done.stdout


def test_the_code_has_the_style_of_the_house(written: Path) -> None:
    for done in style_of(written):
        assert done.returncode == 0, done.stdout + done.stderr
