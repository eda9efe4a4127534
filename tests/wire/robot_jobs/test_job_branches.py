"""Every branch of the shipped jobs is entered; the interpreter notes the labels it comes to."""

import asyncio

import pytest

from fakes.robot_jobs.program import load_program
from fakes.scenario_file.sections import Channel
from tests.rigs.wire.job_rig import JOBS, JobRig, job_rig
from tests.rigs.wire.refusals import REFUSALS
from tests.wire.robot_jobs.job_ways import WAYS, Way


@pytest.mark.parametrize("name", WAYS)
async def test_a_way_through_the_jobs(name: str) -> None:
    way = WAYS[name]
    guard: tuple[Channel, ...] = ("GRD",) if "SJLGRD" in way.enters else ()
    async with job_rig(channels=("CMD", "STA", *guard)) as rig:
        await rig.connect()
        await way.run(rig)
        # A main job whose PC has gone is still on its way when the arm stands already.
        for _ in range(200):
            if not any(missed(rig, way).values()):
                break
            await asyncio.sleep(0.005)
        assert not any(missed(rig, way).values()), missed(rig, way)


def missed(rig: JobRig, way: Way) -> dict[str, set[str]]:
    """The labels that each job has not come to."""
    tasks = rig.controller.tasks
    return {job: labels - tasks[job].entered for job, labels in way.enters.items()}


@pytest.mark.parametrize("job", ["SJLMAIN", "SJLSTA", "SJLGRD"])
def test_no_label_is_left_without_a_way_to_it(job: str) -> None:
    """The refusals have a test of their own, on both fakes."""
    entered = {label for way in WAYS.values() for label in way.enters.get(job, set())}
    if job == "SJLMAIN":
        entered |= {*REFUSALS, "REJECT"}
    assert set(load_program(JOBS / f"{job}.job").labels) == entered
