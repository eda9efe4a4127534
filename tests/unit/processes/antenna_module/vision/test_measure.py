"""A measurement whose uncertainty is no number is refused like one that is too uncertain."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.processes.antenna_module.faults.connector import ConnectorUncertain
from cellctl.processes.antenna_module.vision.measure import require_certain
from cellctl.processes.antenna_module.vision.planar_fit import fit_planar

SQUARE_M = np.array([[0.0, 0.0], [4e-3, 0.0], [4e-3, 4e-3], [0.0, 4e-3]])


@pytest.mark.parametrize("number", [np.nan, -1e-12])
@pytest.mark.parametrize("component", range(3))
def test_what_is_not_a_number_is_refused(component: int, number: float) -> None:
    fit = fit_planar(SQUARE_M, SQUARE_M, np.tile(np.eye(2) * 1e-14, (4, 1, 1)), 1e-6)
    assert fit is not None
    require_certain(fit)
    covariance = fit.covariance.copy()
    covariance[component, component] = number
    with pytest.raises(ConnectorUncertain, match="nan"):
        require_certain(replace(fit, covariance=covariance))
