"""What a recipe may say, beyond the range of a single key."""

import pytest
from pydantic import ValidationError

from cellctl.processes.deck_to_frame.recipe import Mating

BOUNDS = {
    "stop_latency_ms": 300.0,
    "stiffness_n_per_mm": 1000.0,
    "travel_sigma_mm": 0.01,
    "step_sigma_mm": 0.003,
}


def test_the_forces_of_the_paper_are_the_defaults() -> None:
    mating = Mating.model_validate(BOUNDS)
    assert (mating.release_force_n, mating.target_force_n, mating.limit_force_n) == (15, 35, 50)


@pytest.mark.parametrize("wrong", [{"target_force_n": 12.0}, {"limit_force_n": 30.0}])
def test_forces_that_contradict_each_other_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match="release_force_n < target_force_n < limit_force_n"):
        Mating.model_validate(BOUNDS | wrong)
