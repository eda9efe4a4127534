"""The steps of one insertion in their order, with the numbers that the line and the record see."""

from cellctl.processes.peg_in_hole.state import AtHome, PegInserted
from cellctl.processes.peg_in_hole.steps.approach import approach
from cellctl.processes.peg_in_hole.steps.insert_peg import find_and_insert
from cellctl.processes.peg_in_hole.steps.touch_face import find_face
from cellctl.runtime.steps import Restart, Steps, StepSpec

APPROACH = StepSpec(10, "approach", approach)
TOUCH_FACE = StepSpec(20, "touch face", find_face, contact=True)
# Once the peg may be in the hole the steps cannot begin again, so a Hold waits until the run ends.
INSERT = StepSpec(
    30, "search and insert", find_and_insert, contact=True, restart=Restart.NO_WAY_BACK
)

INSERTION: Steps[AtHome, PegInserted] = Steps.first(APPROACH).then(TOUCH_FACE).then(INSERT)
