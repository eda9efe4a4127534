"""The record of a run has what robots were told and reported, and what force sensors felt."""

import asyncio
import errno
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cellctl.cell.robot_layers.noted_robot import NotedRobot
from cellctl.errors.link import LinkLost
from cellctl.errors.records.store import RecordNotWritten
from cellctl.packml.state import State
from cellctl.records.files.mcap_reading import McapContent, read_mcap
from cellctl.records.files.unfinished import MOTION
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.motion_recorder import MotionRecorder
from tests.unit.cell.bench import Bench, make_bench
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
def noted(tmp_path: Path) -> Bench:
    """A cell whose robots take notes, with a steady force."""
    bench = make_bench(tmp_path)
    cell = bench.cell
    cell.robots = {name: cell.robot_notes.noted(robot) for name, robot in cell.robots.items()}  # type: ignore[misc]
    cell.guard.raw = np.tile([0.0, 1.0, -2.0, 0.0, 0.0, 0.0], (5, 1))
    return bench


class Listening:
    """A recorder with its file in memory."""

    def __init__(self, bench: Bench, file: io.BytesIO | None = None) -> None:
        self.file = Kept() if file is None else file
        cell = bench.cell
        self.recorder = MotionRecorder(
            cell.robots, cell.guards, cell.robot_notes, cell.run_notes, self.file
        ).start()

    async def finish(self) -> bytes:
        await self.recorder.finish()
        assert isinstance(self.file, Kept)
        return self.file.content


class Kept(io.BytesIO):
    """Its content outlives its closing."""

    content = b""

    def close(self) -> None:
        self.content = self.getvalue()
        super().close()


class FullDisk(io.BytesIO):
    """Takes so many bytes."""

    room = 100

    def write(self, data: Any) -> int:
        if self.tell() + len(data) > self.room:
            raise OSError(errno.ENOSPC, "No space left on device")
        return super().write(data)


def topics(content: McapContent) -> set[str]:
    return {one.topic for one in content.messages}


async def test_commands_reports_and_forces_are_recorded(noted: Bench) -> None:
    recorder = Listening(noted)
    arm = noted.cell.robots["aux_1"]
    assert isinstance(arm, NotedRobot)
    await arm.move_joint(np.full(6, 0.4), speed_ratio=0.2)
    await arm.stop()
    content = read_mcap(await recorder.finish())
    commands = [one.values for one in content.messages if one.topic == "/robots/aux_1/command"]
    assert [one["what"] for one in commands] == ["move_joint", "stop"]
    assert commands[0]["joints_rad"] == [0.4] * 6
    assert commands[0]["speed_ratio"] == 0.2
    reports = {f"/robots/{name}/report" for name in ("main", "aux_1", "aux_2")}
    assert topics(content) == {"/robots/aux_1/command", "/force/force/raw", *reports}
    assert {one.values["fz_n"] for one in content.messages if "force" in one.topic} == {-2.0}


async def test_after_its_end_nothing_listens(noted: Bench) -> None:
    recorder = Listening(noted)
    await recorder.finish()
    assert noted.cell.robot_notes.listeners == []
    await noted.cell.robots["main"].stop()


async def test_notes_of_the_run_are_recorded_and_what_held_before_it(noted: Bench) -> None:
    notes = noted.cell.run_notes
    notes.tell("/unit/state", {"state": "IDLE"})
    notes.tell("/unit/state", {"state": "STARTING"})
    recorder = Listening(noted)
    notes.tell("/unit/state", {"state": "STARTING"})
    notes.tell("/unit/state", {"state": "EXECUTE"})
    content = read_mcap(await recorder.finish())
    states = [one.values for one in content.messages if one.topic == "/unit/state"]
    assert [one["state"] for one in states] == ["STARTING", "EXECUTE"]
    assert states[0]["time_s"] == pytest.approx(0.0, abs=0.1)
    assert notes.listeners == []


async def test_a_silent_robot_is_a_gap(noted: Bench) -> None:
    noted.cell.aux_1.faults["state"] = LinkLost("aux_1")
    recorder = Listening(noted)
    await asyncio.sleep(0)
    content = read_mcap(await recorder.finish())
    assert "/robots/aux_1/report" not in topics(content)
    assert "/robots/aux_2/report" in topics(content)


async def test_a_disk_that_is_full_ends_the_recording_and_nothing_else(noted: Bench) -> None:
    file = FullDisk()
    listening = Listening(noted, file)
    await noted.cell.robots["main"].stop()
    with pytest.raises(RecordNotWritten, match="No space left"):
        await listening.recorder.finish()
    assert file.closed
    assert noted.cell.robot_notes.listeners == []


@pytest.mark.parametrize("end", [State.COMPLETED, State.ABORTED])
async def test_each_run_has_one_whatever_its_end(rig: DaemonRig, end: State) -> None:
    if end is State.ABORTED:
        rig.bench.cell.main.faults["move"] = LinkLost("main")
    await rig.started()
    await rig.to(end)
    record = await rig.record()
    (artefact,) = (one for one in record.artefacts if one.name == MOTION)
    data = await rig.archive.do(lambda store: store.artefacts.get(artefact.sha256))
    content = read_mcap(data)
    assert content.complete
    assert "/robots/main/report" in topics(content)
    states = [one.values["state"] for one in content.messages if one.topic == "/unit/state"]
    assert states[0] == "STARTING"
    # The record of an aborted run is closed in Aborting, that of a good one in Completing.
    assert states[-1] == ("ABORTING" if end is State.ABORTED else "COMPLETING")
    assert await rig.archive.do(RunStore.verify) == []
    assert list((rig.archive.path / "unfinished").iterdir()) == []
