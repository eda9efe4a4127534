"""The steps of an assembly in their order, each with its safe point before it."""

from dataclasses import dataclass, field

from cellctl import log
from cellctl.processes.deck_to_frame.run import AssemblyRun, StepFunction
from cellctl.processes.deck_to_frame.steps.correct_pose import compensate
from cellctl.processes.deck_to_frame.steps.mate_deck import mate_deck
from cellctl.processes.deck_to_frame.steps.measure_deck import measure_deck
from cellctl.processes.deck_to_frame.steps.measure_frame import measure_frame
from cellctl.processes.deck_to_frame.steps.pre_assembly import pre_assembly
from cellctl.processes.deck_to_frame.steps.verify import verify
from cellctl.runtime.step import Step

_log = log.get(__name__)

STEPS: tuple[tuple[Step, StepFunction], ...] = (
    (Step.MEASURE_FRAME, measure_frame),
    (Step.MEASURE_DECK, measure_deck),
    (Step.PRE_ASSEMBLY, pre_assembly),
    (Step.COMPENSATE, compensate),
    (Step.MATE, mate_deck),
    (Step.VERIFY, verify),
)
_SEATED = frozenset({Step.VERIFY})
"""No way back to the beginning before these: the deck is on the frame."""


@dataclass(slots=True)
class Sequence:
    """Runs the steps, perhaps several times: what a Hold interrupts begins again."""

    single_step: bool = False
    """Hold before each step that was not reached before; with every Unhold the run measures anew
    and gets one step further."""
    until_mating: bool = False
    """A dry run: everything without contact."""
    steps: tuple[tuple[Step, StepFunction], ...] = STEPS
    _held_before: set[Step] = field(default_factory=set)

    async def run(self, run: AssemblyRun, run_number: int) -> None:
        """All steps from the first one; ``HeldMeanwhile`` when they must begin again."""
        for step, function in self.steps:
            if self.until_mating and step >= Step.MATE:
                _log.info("dry run: ends before the mating")
                return
            if step not in _SEATED:
                await run.safe_point(hold=self._wants_hold(step))
            run.board.update(step=step, message="")
            with log.bound(run=run_number, step=step.label):
                _log.info("step begins")
                await function(run)

    def _wants_hold(self, step: Step) -> bool:
        new = self.single_step and step not in self._held_before
        self._held_before.add(step)
        return new
