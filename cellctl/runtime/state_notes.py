"""State, mode and step of the unit in the recording of a run."""

from cellctl.cell.run_notes import RunNotes
from cellctl.packml.machine import PackMLMachine
from cellctl.runtime.progress import ProgressBoard

STATE_TOPIC = "/unit/state"


def note_states(machine: PackMLMachine, board: ProgressBoard, notes: RunNotes) -> None:
    """Tell the notes of every change from now on."""

    def tell() -> None:
        progress = board.current
        values = {
            "state": machine.state.name,
            "state_requested": machine.state_requested.name,
            "mode": machine.mode.name,
            "step": progress.step,
            "step_label": progress.step_label,
            "iteration": progress.iteration,
            "message": progress.message,
        }
        notes.tell(STATE_TOPIC, values)

    machine.on_change.append(lambda _before, _after: tell())
    board.observers.append(lambda _progress: tell())
