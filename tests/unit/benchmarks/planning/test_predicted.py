import numpy as np
import pytest

from benchmarks.metrology.fake_station import SCENARIO
from benchmarks.planning.predicted import compare, prediction
from cellctl.planning.views.prediction import PredictedPose
from fakes.scenes.deck_on_frame.scenario import DeckScenario


@pytest.fixture(scope="module")
def predicted() -> PredictedPose:
    return prediction(DeckScenario.read(SCENARIO, {}))


@pytest.mark.parametrize(("times", "honest"), [(1.0, True), (1.4, False), (0.6, False)])
def test_a_scatter_is_honest_or_not(predicted: PredictedPose, times: float, honest: bool) -> None:
    rng = np.random.default_rng(3)
    covariance = predicted.covariance
    drawn = rng.multivariate_normal(np.zeros(6), times**2 * covariance, size=400)
    measured = [{"off": off.tolist(), "cov": covariance.tolist()} for off in drawn]
    table, found = compare(measured, predicted)
    assert found is honest
    assert "400 cells" in str(table.title)
