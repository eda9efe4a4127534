"""Pins without chamfers in tight holes: classes B and C of the study's requirement R1.

Each is the shipped pin with another fit and another stiffness. The cell is told both, as a drawing
and procedure 301 would tell them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from benchmarks.insertion.cycles import CycleCell
from benchmarks.insertion.farmed import shipped_cell

_SOFT_N_MM, _STIFF_N_MM = 98.0, 880.0
"""Stiffness times a dead time of 27 ms: 2.6e3 and 2.4e4 N·s/m."""
_NO_CHAMFERS = {"hole_chamfer_mm": 0.0, "peg_chamfer_mm": 0.0}


@dataclass(frozen=True, slots=True)
class TightPin:
    """What differs from the shipped pin."""

    clearance_mm: float
    """Radial."""
    stiffness_n_mm: float


TIGHT_PINS: Mapping[str, TightPin] = {
    "b-50um": TightPin(0.05, _SOFT_N_MM),
    "b-20um": TightPin(0.02, _SOFT_N_MM),
    "b-50um-stiff": TightPin(0.05, _STIFF_N_MM),
    "b-20um-stiff": TightPin(0.02, _STIFF_N_MM),
    "c-10um": TightPin(0.01, _SOFT_N_MM),
}
"""By class, clearance and arm."""


@cache
def tight_pin_cell(name: str) -> CycleCell:
    """Made once in each process."""
    shipped, pin = shipped_cell("pin"), TIGHT_PINS[name]
    recipe = shipped.recipe.model_dump(exclude_unset=True)
    recipe["fit"] |= {"clearance_mm": pin.clearance_mm, **_NO_CHAMFERS}
    settings = shipped.settings.model_dump(exclude_unset=True)
    settings["stiffness_n_mm"] = pin.stiffness_n_mm
    true = shipped.scenario
    bore_mm = true.fit.peg_radius_mm + pin.clearance_mm
    fit = true.fit.model_copy(update={"bore_radius_mm": bore_mm, **_NO_CHAMFERS})
    arm = 1e3 * pin.stiffness_n_mm
    compliance = true.compliance.model_copy(update={"axial_n_m": arm, "lateral_n_m": arm})
    scenario = true.model_copy(update={"fit": fit, "compliance": compliance})
    return CycleCell.told(scenario, recipe, settings)
