"""The kinds of calibration of this process."""

from typing import Any

from cellctl.calibration.store.kind import CalibrationKind
from cellctl.processes.peg_in_hole.record.loop_record import figures_of_record

CONTACT_LOOP = CalibrationKind(
    name="contact_loop",
    parse=figures_of_record,
    procedures=(301,),
    required=False,
    per_recipe=True,
)
"""Stiffness and dead time of the loop through arm, gripped part and sensor; they replace the bounds
of the settings. Of each recipe one, because fingers and part belong to the stiffness."""

CALIBRATIONS: tuple[CalibrationKind[Any], ...] = (CONTACT_LOOP,)
