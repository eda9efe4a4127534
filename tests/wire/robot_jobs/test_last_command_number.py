"""The number of a command has seven digits: what happens behind the last one."""

import asyncio

import pytest

from cellctl.errors.link import LinkLost
from drivers.robot.siasun.channels.command_channel import MOST_COMMANDS
from drivers.robot.siasun.codec.compact.words import CompactWords
from tests.rigs.wire.any_rig import move, rearm, within
from tests.rigs.wire.job_rig import JobRig, job_rig

LAST_SESSION = 999_999
OFFSET = 1_000_000
"""The job keeps the last number as it was sent."""


def count_on_from(rig: JobRig, number: int) -> None:
    """Count on as if so many commands had been given in this session."""
    rig.robot._command._seq = number
    rig.robot._command.channel.session = LAST_SESSION
    rig.controller.memory.numbers["I", 73] = LAST_SESSION + OFFSET
    rig.controller.memory.numbers["I", 74] = number + OFFSET


async def test_the_last_one_is_obeyed_and_the_next_begins_a_new_session() -> None:
    async with job_rig() as rig:
        await rig.connect()
        await rearm(rig)
        count_on_from(rig, MOST_COMMANDS - 1)
        await within(2.0, move(rig, 1.0))
        assert rig.robot._command._seq == MOST_COMMANDS
        before = rig.arm.encoder_pose(rig.controller._clock()).translation
        with pytest.raises(LinkLost, match="new session"):
            await move(rig, 1.0)
        await asyncio.sleep(0.3)
        after = rig.arm.encoder_pose(rig.controller._clock()).translation
        assert after == pytest.approx(before), "nothing was sent"
        await rearm(rig)
        assert rig.robot._command.channel.session != LAST_SESSION
        await within(2.0, move(rig, 1.0))
        assert rig.robot._command._seq < 10
        assert not rig.controller.alarm


@pytest.mark.parametrize("value", [-12_000.0, 12_000.0])
def test_no_record_gets_longer_up_to_it(value: float) -> None:
    """No arm is sent beyond 12 m, and what is not a length is smaller."""
    words = CompactWords(1000.0)
    record = words.move_linear(LAST_SESSION, MOST_COMMANDS, (value,) * 6, 2000.0, 1000.0)
    assert len(record) == 119
