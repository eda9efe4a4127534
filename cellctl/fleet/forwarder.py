"""Delivers a cell's records as long as it runs, however long the server is away."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from cellctl import log
from cellctl.clock import utc_now
from cellctl.errors.base import CellError
from cellctl.errors.records.fleet import FleetUnreachable
from cellctl.errors.records.store import RecordsError, StoreTooNew
from cellctl.fleet.delivery import Delivery
from cellctl.records.files.delivery_file import DeliveryState

_log = log.get(__name__)


@dataclass(frozen=True, slots=True)
class ForwarderPace:
    """How often the store and the server are asked."""

    look_s: float = 2.0
    """Pause between two looks for new entries."""
    retry_s: float = 2.0
    """Pause after the first failure; twice as long after each further one."""
    retry_most_s: float = 60.0


PACE = ForwarderPace()


class Forwarder:
    """One cell to one fleet database.

    Started and ended at will, by a signal too: it keeps nothing that a start would need.
    """

    def __init__(
        self,
        delivery: Delivery,
        pace: ForwarderPace = PACE,
        wait: Callable[[float], None] = time.sleep,
        tell: Callable[[DeliveryState], None] = lambda _state: None,
    ) -> None:
        """``tell`` is given the state after each turn; it must not raise."""
        self._delivery = delivery
        self._pace = pace
        self._wait = wait
        self._tell = tell
        self._state = DeliveryState(told=utc_now(), delivered=None, still_to_come=None)
        self._failures = 0

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Deliver and wait, until somebody ends the program or ``until`` is true.

        Raises ``StoreTooNew`` when cellctl was upgraded below it: it has to be started anew.
        """
        while not until():
            pause_s = self._once()
            self._tell(self._state)
            self._wait(pause_s)

    def _once(self) -> float:
        """One batch, or the reason why not; how long to wait."""
        try:
            left = self._delivery.deliver()
        except StoreTooNew:
            raise
        except RecordsError as fault:
            return self._failed(fault)
        if self._state.fault:
            _log.info("records are delivered again", still_to_come=left)
        now = utc_now()
        self._state = DeliveryState(told=now, delivered=now, still_to_come=left)
        self._failures = 0
        return 0.0 if left else self._pace.look_s

    def _failed(self, fault: CellError) -> float:
        self._failures += 1
        if str(fault) != self._state.fault:
            # Said once, and again when the reason is another one: a server may be away for weeks.
            write = _log.warning if isinstance(fault, FleetUnreachable) else _log.error
            write("records are not delivered", fault=str(fault), remedy=fault.remedy)
        changes = {"told": utc_now(), "fault": str(fault), "remedy": fault.remedy}
        self._state = self._state.model_copy(update=changes)
        doubled = self._pace.retry_s * 2.0 ** min(self._failures - 1, 16)
        return min(doubled, self._pace.retry_most_s)
