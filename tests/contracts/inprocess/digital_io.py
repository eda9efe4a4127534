"""Digital inputs and outputs in memory."""

from collections.abc import Mapping

from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.digital_io import OutputsDropped, SignalUnknown
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces.digital_io import DigitalIo, DigitalIoState


class InProcessIo(DigitalIo):
    """Signals that are set and seen by the test."""

    def __init__(self, name: str, inputs: tuple[str, ...], outputs: tuple[str, ...]) -> None:
        self.name = name
        self.input_names, self.output_names = inputs, outputs
        self.inputs = dict.fromkeys(inputs, False)
        self.driven = dict.fromkeys(outputs, False)
        self.writes = 0
        self.silent = False
        self._fault: CellError | None = LinkLost(name)

    async def connect(self) -> None:
        self._fault = None

    async def disconnect(self) -> None:
        self.end(LinkLost(self.name))

    async def let_go(self) -> None:
        self._fault = LinkLost(self.name)

    def end(self, fault: CellError) -> None:
        self._fault = fault
        self.driven = dict.fromkeys(self.driven, False)

    async def read(self) -> DigitalIoState:
        self._check()
        return DigitalIoState(now_s(), dict(self.inputs), dict(self.driven))

    async def write(self, outputs: Mapping[str, bool]) -> None:
        if outputs.keys() - set(self.output_names):
            raise SignalUnknown(self.name)
        self._check()
        self.writes += len(outputs)
        self.driven.update(outputs)

    def drop(self) -> None:
        self.end(OutputsDropped(self.name))

    def _check(self) -> None:
        if self.silent:
            self.end(ReplyTimeout(self.name))
        if self._fault is not None:
            raise self._fault
