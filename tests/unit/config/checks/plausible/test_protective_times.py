"""The table of times that protect, in the words of docs/guard.md."""

from pathlib import Path

from cellctl.config.checks.plausible.protective_times import PROTECTIVE_TIMES

_GUARD = Path(__file__).parents[5] / "docs" / "guard.md"


def test_the_page_has_every_time_with_its_bounds_and_reason() -> None:
    text = _GUARD.read_text()
    for name, rule in PROTECTIVE_TIMES.items():
        row = f"| `{name}` | {rule.most_s:g} | {rule.most_simulated_s:g} | {rule.why} |"
        assert row in text


def test_no_real_cell_may_wait_longer_than_a_simulated_one() -> None:
    assert all(rule.most_s <= rule.most_simulated_s for rule in PROTECTIVE_TIMES.values())
