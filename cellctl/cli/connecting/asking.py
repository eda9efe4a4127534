"""Asks all devices of a cell at once, those first that tell whether somebody has the cell."""

import asyncio
import threading
from collections.abc import Callable, Coroutine, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from cellctl.cli.connecting.answer import Answer, answered
from cellctl.cli.connecting.cameras import OF_A_FAKE_CELL, ask_camera, ask_tracker
from cellctl.cli.connecting.guards import ask_sensor, ask_stop_channel
from cellctl.cli.connecting.instruments import with_instruments
from cellctl.cli.connecting.line import line_port_held
from cellctl.cli.connecting.outputs import ask_gripper, ask_io
from cellctl.cli.connecting.robots import ask_robot
from cellctl.config import CellConfig
from cellctl.config.devices import CameraConfig
from cellctl.errors.link import ConnectTimeout, PortInUse
from cellctl.errors.local import CellInUse

Questions = Mapping[str, Coroutine[Any, Any, Answer]]


async def ask_devices(
    cell: CellConfig, folder: Path, tell: Callable[[str, bool], None]
) -> list[Answer]:
    """The answers in the order of the cell file, that of the line last.

    ``folder`` holds the cell file; ``tell`` is called with the path of each device when it is being
    asked (True) and when it has answered or failed (False). Raises ``CellInUse`` when a daemon
    serves the line. When a robot's port is taken, no device is asked any more: the program that has
    it may have the outputs, cameras and sensors too, and would lose them.
    """
    with line_port_held(cell.plc) as line:
        found = await _robots_and_channels(cell, tell)
        taken = [one.path for one in found if isinstance(one.fault, PortInUse)]
        others = _others(cell)
        if taken:
            for question in others.values():
                question.close()
            why = f"another program has the ports of {', '.join(taken)}"
            drivers = _drivers(cell)
            found += [Answer(path, drivers[path], fault=CellInUse(why)) for path in others]
        else:
            found += await _asked(cell, others, tell)
    found = [_of_a_fake_cell(cell, answer) for answer in found]
    compared = with_instruments(cell, folder / cell.calibration_dir, found)
    return [*_in_order(cell, compared), line]


async def _asked(
    cell: CellConfig, questions: Questions, tell: Callable[[str, bool], None]
) -> list[Answer]:
    drivers = _drivers(cell)

    async def one(path: str, question: Coroutine[Any, Any, Answer]) -> Answer:
        tell(path, True)  # noqa: FBT003 - begun
        answer = await answered(path, drivers[path], question)
        tell(path, False)  # noqa: FBT003
        return answer

    async with asyncio.TaskGroup() as tasks:
        asked = [tasks.create_task(one(*item)) for item in questions.items()]
    return [task.result() for task in asked]


async def _robots_and_channels(cell: CellConfig, tell: Callable[[str, bool], None]) -> list[Answer]:
    """Together, since a controller may open its connections together only."""
    robots_asked = threading.Event()
    channels = {
        f"force_sensors.{name}.stop_channel": ask_stop_channel(name, sensor, robots_asked)
        for name, sensor in cell.force_sensors.items()
    }
    async with asyncio.TaskGroup() as tasks:
        of_channels = tasks.create_task(_asked(cell, channels, tell))
        robots = {f"robots.{name}": ask_robot(cell, name) for name in cell.robots}
        found = await _asked(cell, robots, tell)
        robots_asked.set()
    return [*found, *of_channels.result()]


def _others(cell: CellConfig) -> Questions:
    questions: dict[str, Coroutine[Any, Any, Answer]] = {}
    for name, head in cell.stereo_cameras.items():
        questions[f"stereo_cameras.{name}"] = ask_camera("stereo_cameras", name, head)
    for name, camera in cell.cameras.items():
        questions[f"cameras.{name}"] = ask_camera("cameras", name, camera)
    for name, tracker in cell.trackers.items():
        questions[f"trackers.{name}"] = ask_tracker(name, tracker)
    for name, sensor in cell.force_sensors.items():
        questions[f"force_sensors.{name}"] = ask_sensor(name, sensor)
    for name, gripper in cell.grippers.items():
        questions[f"grippers.{name}"] = ask_gripper(name, gripper)
    for name, io in cell.digital_ios.items():
        questions[f"digital_ios.{name}"] = ask_io(name, io)
    return questions


def _of_a_fake_cell(cell: CellConfig, answer: Answer) -> Answer:
    """A fake cell may show its cameras in two ways, and a cell file knows one of them."""
    device = cell.devices()[answer.path][1]
    silent = isinstance(answer.fault, ConnectTimeout)
    if not (silent and isinstance(device, CameraConfig) and device.simulated):
        return answer
    return replace(answer, notes=(*answer.notes, OF_A_FAKE_CELL))


def _drivers(cell: CellConfig) -> dict[str, str]:
    return {path: device.driver for path, (_, device) in cell.devices().items()}


def _in_order(cell: CellConfig, answers: Iterable[Answer]) -> list[Answer]:
    order = list(cell.devices())
    return sorted(answers, key=lambda answer: order.index(answer.path))
