"""The kinds of calibration of this process."""

from typing import Any

from cellctl.calibration.store.kind import CalibrationKind
from cellctl.errors.robot import ControllerFault
from cellctl.processes.peg_in_hole.faults import PanelOffReference
from cellctl.processes.peg_in_hole.panel_reference import PanelReference
from cellctl.processes.peg_in_hole.record.loop_record import figures_of_record

CONTACT_LOOP = CalibrationKind(
    name="contact_loop",
    parse=figures_of_record,
    procedures=(301,),
    invalidated_by=frozenset({PanelOffReference}),
    required=False,
    per_recipe=True,
)
"""Stiffness and dead time of the loop through arm, gripped part and sensor; they replace the bounds
of the settings. Of each recipe one, because fingers and part belong to the stiffness."""

PANEL_REFERENCE = CalibrationKind(
    name="panel_reference",
    parse=PanelReference.from_record,
    procedures=(302,),
    # A robot reports a collision as an error of its controller.
    invalidated_by=frozenset({PanelOffReference, ControllerFault}),
    required=False,
    per_recipe=True,
)
"""Where the arm meets the face of each recipe. A cell that has never taken one works without; one
that has taken one does not start without it (``read_facts``)."""

CALIBRATIONS: tuple[CalibrationKind[Any], ...] = (CONTACT_LOOP, PANEL_REFERENCE)
