"""The table of times that protect, in the words of docs/guard.md."""

import re
from pathlib import Path

import pytest

from cellctl.config.checks.protective_times import PROTECTIVE_TIMES
from cellctl.config.load import load_cell
from cellctl.errors.config import ConfigInvalid
from tests.unit.config.mistake import Mistake
from tests.unit.config.protective_mistakes import TOO_LONG
from tests.unit.config.test_mistakes import written

_GUARD = Path(__file__).parents[4] / "docs" / "guard.md"


def test_the_page_has_every_time_with_its_bounds_and_reason() -> None:
    text = _GUARD.read_text()
    for name, rule in PROTECTIVE_TIMES.items():
        row = f"| `{name}` | {rule.most_s:g} | {rule.most_simulated_s:g} | {rule.why} |"
        assert row in text


def test_no_real_cell_may_wait_longer_than_a_simulated_one() -> None:
    assert all(rule.most_s <= rule.most_simulated_s for rule in PROTECTIVE_TIMES.values())


@pytest.mark.parametrize("slip", TOO_LONG, ids=lambda one: f"{one.file}-{one.key}")
def test_a_daemon_does_not_start_with_a_time_that_is_too_long(
    tmp_path: Path, slip: Mistake
) -> None:
    path = written(tmp_path, slip.file, slip.old, slip.new)
    with pytest.raises(ConfigInvalid, match=re.escape(slip.key)):
        load_cell(path)
