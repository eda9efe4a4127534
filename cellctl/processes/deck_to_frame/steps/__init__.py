"""The steps of an assembly in their order, with the numbers that the line and the record see."""

from cellctl.processes.deck_to_frame.state import AtStandOff, Ready, Verified
from cellctl.processes.deck_to_frame.steps.correct_pose import LABEL, NUMBER, correct_pose
from cellctl.processes.deck_to_frame.steps.mate_deck import mate_deck
from cellctl.processes.deck_to_frame.steps.measure_deck import measure_deck
from cellctl.processes.deck_to_frame.steps.measure_frame import measure_frame
from cellctl.processes.deck_to_frame.steps.pre_assembly import pre_assembly
from cellctl.processes.deck_to_frame.steps.verify import verify
from cellctl.runtime.steps import Restart, Steps, StepSpec

MEASURE_FRAME = StepSpec(10, "measure frame", measure_frame)
MEASURE_DECK = StepSpec(20, "measure deck", measure_deck)
PRE_ASSEMBLY = StepSpec(30, "pre-assembly", pre_assembly)
CORRECT_POSE = StepSpec(NUMBER, LABEL, correct_pose, safe_points_within=True)
MATE = StepSpec(50, "mate", mate_deck, contact=True)
# The deck is on the frame, and measuring anew would begin with it in the gripper, clear of the
# station: a Hold waits until the run has ended.
VERIFY = StepSpec(60, "verify", verify, restart=Restart.NO_WAY_BACK)

TO_STAND_OFF: Steps[Ready, AtStandOff] = (
    Steps.first(MEASURE_FRAME).then(MEASURE_DECK).then(PRE_ASSEMBLY)
)
ASSEMBLY: Steps[Ready, Verified] = TO_STAND_OFF.then(CORRECT_POSE).then(MATE).then(VERIFY)
