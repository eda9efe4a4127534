"""The contact in the permit loop: open with every stop, closed before the release."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.devices import Cell
from cellctl.cell.robot_layers.permitted_robot import PermittedRobot, PermittedStreamingRobot
from cellctl.config import CellConfig
from cellctl.config.checks.cross_checks import cross_issues
from cellctl.errors.base import CellError
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.errors.robot import ControllerFault, StopFailed, TargetOutOfBounds
from cellctl.interfaces import StreamingRobot, StreamLimits
from tests.contracts.inprocess.digital_io import InProcessIo
from tests.unit.cell.robots import StillRobot


@pytest.fixture
async def io() -> InProcessIo:
    io = InProcessIo("permit", (), ("main", "spare"))
    await io.connect()
    return io


@pytest.fixture
def behind(io: InProcessIo) -> StillRobot:
    return StillRobot("main")


@pytest.fixture
def robot(io: InProcessIo, behind: StillRobot) -> PermittedRobot:
    return PermittedRobot(behind, io, "main")


async def test_a_release_closes_it_and_a_stop_opens_it(
    io: InProcessIo, robot: PermittedRobot, behind: StillRobot
) -> None:
    await robot.rearm()
    assert io.driven == {"main": True, "spare": False}
    await robot.stop()
    assert io.driven["main"] is False
    assert (behind.stops, behind.latched) == (1, True)


async def test_it_opens_although_the_robot_does_not_confirm(
    io: InProcessIo, robot: PermittedRobot, behind: StillRobot
) -> None:
    await robot.rearm()
    behind.faults["stop"] = StopFailed("main")
    with pytest.raises(StopFailed):
        await robot.stop()
    assert io.driven["main"] is False


async def test_a_silent_coupler_does_not_hold_up_the_stop(
    io: InProcessIo, robot: PermittedRobot, behind: StillRobot
) -> None:
    await robot.rearm()
    io.silent = True
    await robot.stop()
    assert behind.stops == 1
    io.silent = False
    with pytest.raises((LinkLost, ReplyTimeout)):
        await robot.rearm()
    assert behind.latched


async def test_whoever_gives_up_the_stop_leaves_it_open(
    io: InProcessIo, robot: PermittedRobot
) -> None:
    await robot.rearm()
    stopping = asyncio.create_task(robot.stop())
    await asyncio.sleep(0)
    stopping.cancel()
    await asyncio.gather(stopping, return_exceptions=True)
    assert io.driven["main"] is False


@pytest.mark.parametrize("fault", [LinkLost("main"), ReplyTimeout("main"), ControllerFault("17")])
async def test_it_opens_when_a_motion_ends_in_doubt(
    io: InProcessIo, robot: PermittedRobot, behind: StillRobot, fault: CellError
) -> None:
    up = RigidTransform.from_translation([1.5, 0.0, 1.6])
    moves: tuple[Callable[[], Awaitable[object]], ...] = (
        lambda: robot.move_joint(np.zeros(6), speed_ratio=0.1),
        lambda: robot.move_linear(up, speed_m_s=0.01, acceleration_m_s2=0.1),
        lambda: robot.step(up, speed_m_s=0.01),
    )
    for move in moves:
        behind.faults.clear()
        await robot.rearm()
        await move()
        assert io.driven["main"] is True
        behind.faults["move"] = fault
        with pytest.raises(type(fault)):
            await move()
        assert io.driven["main"] is False


async def test_a_motion_that_is_refused_leaves_it_closed(
    io: InProcessIo, robot: PermittedRobot, behind: StillRobot
) -> None:
    await robot.rearm()
    behind.faults["move"] = TargetOutOfBounds("main")
    with pytest.raises(TargetOutOfBounds):
        await robot.step(RigidTransform.identity(), speed_m_s=0.01)
    assert io.driven["main"] is True


async def test_it_opens_when_a_stream_loses_its_link(
    io: InProcessIo, monkeypatch: pytest.MonkeyPatch
) -> None:
    @asynccontextmanager
    async def stream(_limits: StreamLimits) -> AsyncIterator[None]:
        yield

    behind = StillRobot("main")
    monkeypatch.setattr(behind, "stream", stream, raising=False)
    robot = PermittedStreamingRobot(cast(StreamingRobot, behind), io, "main")
    await robot.rearm()
    closed: list[object] = []

    async def lose_it() -> None:
        async with robot.stream(cast(StreamLimits, None)):
            closed.append(io.driven["main"])
            raise LinkLost("main")

    with pytest.raises(LinkLost):
        await lose_it()
    assert closed == [True]
    assert io.driven["main"] is False


def cell(**permits: dict[str, str]) -> CellConfig:
    driver = {"driver": "siasun-sjl", "settings": {}}
    coupler = {"host": "127.0.0.1", "outputs": {"a": 0, "b": 1}}
    return CellConfig.model_validate(
        {
            "name": "cell",
            "data_dir": "/tmp/none",
            "robots": {name: driver | {"permit": permit} for name, permit in permits.items()},
            "digital_ios": {"loop": {"driver": "modbus-coupler", "settings": coupler}},
        }
    )


def test_the_check_knows_the_contacts() -> None:
    good = cell(one={"device": "loop", "output": "a"}, two={"device": "loop", "output": "b"})
    assert not [issue for issue in cross_issues(good, []) if "permit" in issue.key]
    bad = cell(one={"device": "pool", "output": "a"}, two={"device": "pool", "output": "a"})
    keys = {issue.key for issue in cross_issues(bad, []) if "permit" in issue.key}
    assert keys == {
        f"robots.{name}.permit.{key}" for name in ("one", "two") for key in ("device", "output")
    }


def test_a_cell_puts_it_before_its_robots(tmp_path: Path) -> None:
    settings = {
        "robot_name": "ARM", "command_port": 7001, "state_port": 7002,
        "workspace_min_mm": [0, 0, 0], "workspace_max_mm": [1, 1, 1],
        "joints_min_deg": [-1] * 6, "joints_max_deg": [1] * 6, "max_speed_mm_s": 10,
    }  # fmt: skip
    config = cell(one={"device": "loop", "output": "a"}).model_dump()
    config["robots"]["one"]["settings"] = settings
    built = Cell(CellConfig.model_validate(config), tmp_path)
    assert isinstance(built.robots["one"]._robot, PermittedRobot)  # type: ignore[attr-defined]
