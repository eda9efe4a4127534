"""How a run ended, in words."""

import pytest

from cellctl.records.outcome import outcome


@pytest.mark.parametrize(
    ("mode", "result", "spoilt", "words"),
    [
        ("production", None, False, "open"),
        ("production", "good", False, "good"),
        ("production", "good", True, "good, bad by gauge"),
        ("production", "bad", False, "bad"),
        ("dry run", "bad", False, "done, no part"),
        ("dry run", "aborted", False, "aborted"),
        ("dry run", None, False, "open"),
    ],
)
def test_a_dry_run_that_ended_as_meant_is_not_bad(
    mode: str, result: str | None, *, spoilt: bool, words: str
) -> None:
    assert outcome(mode, result, spoilt=spoilt) == words
