"""Controllers of industrial arms at the far end of a benchmark, in a process of their own."""

import asyncio
from multiprocessing.connection import Connection

from benchmarks.robot.stalls import StallWatch
from fakes.robot_jobs.controller import JobController
from fakes.scenario_file.sections import Channel
from fakes.wire.sjl.controller import SjlController
from tests.rigs.wire.standing_arm import standing_arm

Ports = dict[Channel, int]


def serve_controller(pipe: Connection, way: str, ports: Ports, statement_s: float) -> None:
    """Connect to a driver until anything comes through the pipe. ``way`` is ``sjl`` for the
    protocol's text, ``jobs`` for the shipped jobs with so much time for each statement. Answers
    with the longest time, in s, for which its loop got no turn."""
    asyncio.run(_serve(pipe, way, ports, statement_s))


async def _serve(pipe: Connection, way: str, ports: Ports, statement_s: float) -> None:
    arm, clock = standing_arm()
    controller = (
        SjlController(arm, clock, ports)
        if way == "sjl"
        else JobController(arm, clock, ports, statement_s=statement_s)
    )
    async with StallWatch() as stalls:
        controller.start()
        await asyncio.to_thread(pipe.recv)
    pipe.send(stalls.longest_s)
    await controller.stop()
