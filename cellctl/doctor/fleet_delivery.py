"""Whether records reach the fleet database, where the cell has one."""

from collections.abc import Iterator
from datetime import UTC, datetime

from cellctl.config.cell import CellConfig
from cellctl.doctor.finding import Finding, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.records.files.delivery_file import FOLDER, NAME, DeliveryState, read_state

_START = "sudo systemctl enable --now cellctl-forward; then journalctl -u cellctl-forward"


def delivery_findings(pc: Pc, cell: CellConfig) -> Iterator[Finding]:
    """What the forwarder has told last; nothing for a cell without ``[fleet]``.

    Never bad: the cell works without the fleet, and delivers later what it has recorded.
    """
    if cell.fleet is None:
        return
    text = pc.read(FOLDER / NAME)
    state = None if text is None else read_state(text)
    now = datetime.fromtimestamp(pc.time_s(), UTC)
    if state is None:
        yield doubtful("delivery", "nothing is heard of a forwarder on this PC", _START)
    elif state.silent(now):
        yield doubtful("delivery", f"the forwarder is silent since {_time(state.told)}", _START)
    elif state.fault:
        found = f"{_waiting(state)}{_since(state)}: {state.fault}"
        yield doubtful("delivery", found, state.remedy)
    else:
        yield good("delivery", f"{_waiting(state)}{_since(state)}")


def _waiting(state: DeliveryState) -> str:
    if state.still_to_come is None:
        return "nothing delivered yet"
    if state.still_to_come:
        return f"{state.still_to_come} entries still to come"
    return "all entries delivered"


def _since(state: DeliveryState) -> str:
    return "" if state.delivered is None else f", the last at {_time(state.delivered)}"


def _time(moment: datetime) -> str:
    return f"{moment:%Y-%m-%d %H:%M:%S} UTC"
