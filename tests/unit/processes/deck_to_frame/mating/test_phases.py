"""What the first phases require before anything moves."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import ContactPlanInvalid, TareImplausible
from cellctl.interfaces import Robot
from cellctl.processes.deck_to_frame.mating.phases import _require_plausible, require_stand_off
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan


@pytest.mark.parametrize("off", [(1e-3, 0.0), (0.0, 0.1), (np.nan, 0.0), (0.0, np.nan)])
def test_an_arm_that_is_elsewhere_or_nowhere_begins_no_mating(off: tuple[float, float]) -> None:
    state = SimpleNamespace(moving=False, distance_to=lambda _pose: off)
    settings = SimpleNamespace(stand_off_tolerance=(2e-4, 3e-4))
    plan = SimpleNamespace(base_T_flange=RigidTransform.identity(), settings=settings)
    with pytest.raises(ContactPlanInvalid):
        require_stand_off(cast(Robot, SimpleNamespace(state=lambda: state)), cast(MatingPlan, plan))


@pytest.mark.parametrize("component", range(6))
def test_a_zero_that_is_not_a_number_is_no_zero(component: int) -> None:
    mean = np.zeros(6)
    mean[component] = np.nan
    with pytest.raises(TareImplausible):
        _require_plausible(mean, (80.0, 40.0))
