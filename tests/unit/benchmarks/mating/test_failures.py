"""Injected failures: the right fault, at rest, below 50 N where physics allows it."""

import pytest

from benchmarks.mating.failures import FAILURES, run_failure

TRIED_HERE = (
    "sensor silent, creep",
    "sensor frozen, guarded travel",
    "sensor at half its rate",
    "sensor saturated",
    "NaN-like bytes",
    "robot link lost, creep",
    "stop request ignored once",
    "every stop request ignored",
    "contact 0.25 mm early",
)
"""The rest runs in `make campaign-mating`."""
QUICK = ("sensor frozen, guarded travel",)
"""Of these, what a standard run of the tests has the time for. That the guard's monitor notices the
others is tried without a cell in `tests/unit/guard`."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name in QUICK else pytest.mark.long) for name in TRIED_HERE],
)
def test_failure(name: str) -> None:
    index = next(i for i, failure in enumerate(FAILURES) if failure.name == name)
    failure = FAILURES[index]
    trial = run_failure(index)
    assert trial.outcome in failure.outcomes, trial.text
    assert trial.standing
    assert trial.true_peak_n < 50.0
    backed_off_mm = trial.reached_mm - trial.end_travel_mm
    if name.startswith(("sensor", "NaN")):
        assert backed_off_mm < 0.4, "nobody could watch the way back"
    elif trial.outcome.startswith("F5"):
        assert backed_off_mm > 1.5
