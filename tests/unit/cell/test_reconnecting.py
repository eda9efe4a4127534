"""Clear gives devices their link back that do not ask for it themselves."""

import pytest

from cellctl.cell.reconnecting import reconnect
from cellctl.errors.digital_io import OutputsDropped
from cellctl.errors.link import ConnectTimeout
from tests.contracts.inprocess.digital_io import InProcessIo


class Unreachable(InProcessIo):
    """Nobody listens at its address."""

    async def connect(self) -> None:
        raise ConnectTimeout(self.name)


class Defective(InProcessIo):
    """Its driver has a defect."""

    async def connect(self) -> None:
        raise ValueError(self.name)


async def test_one_that_has_dropped_its_outputs_answers_again() -> None:
    dropped, away = InProcessIo("permit", (), ("main",)), Unreachable("lamps", (), ("ring",))
    await dropped.connect()
    dropped.drop()
    with pytest.raises(OutputsDropped):
        await dropped.read()
    await reconnect({"lamps": away, "permit": dropped})
    assert (await dropped.read()).outputs == {"main": False}


async def test_a_defect_is_not_taken_for_a_device() -> None:
    with pytest.raises(ValueError, match="permit"):
        await reconnect({"permit": Defective("permit", (), ("main",))})
