"""What commissioning has measured about contact; it makes matings faster within the same limits.

A recipe states bounds that are safe without any measurement. A commissioned figure replaces its
bound while its record is there, passed and valid; otherwise the bound counts.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cellctl.calibration.store.snapshot import CalibrationSnapshot


@dataclass(frozen=True, slots=True)
class Commissioned:
    """Upper bounds from measurements; None where the recipe's bound counts."""

    stop_latency_s: float | None = None
    stiffness_n_m: float | None = None
    """Arm and contact in series, as measured with one pair of parts."""

    @classmethod
    def of(cls, snapshot: "CalibrationSnapshot", recipe_id: int) -> "Commissioned":
        """The figures in a snapshot; the stiffness is that of one recipe's parts."""
        # Here, because `cellctl check` needs the bounds alone, and not the solvers of all kinds.
        from cellctl.processes.deck_to_frame.calibrations import CONTACT_STIFFNESS, STOP_LATENCY

        return cls(
            stop_latency_s=snapshot.find(STOP_LATENCY),
            stiffness_n_m=snapshot.find(CONTACT_STIFFNESS.for_recipe(recipe_id)),
        )
