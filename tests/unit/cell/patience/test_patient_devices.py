"""No call of a device is waited for for ever, whatever its kind."""

import asyncio
import inspect
from collections.abc import Callable
from typing import Any

import pytest

from cellctl.cell.devices import Cell
from cellctl.cell.patience.patient_devices import (
    PatientCamera,
    PatientDevice,
    PatientGripper,
    PatientHead,
    PatientIo,
    PatientTracker,
)
from cellctl.cell.patience.patient_robot import PatientRobot
from cellctl.errors.link import ReplyTimeout
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE

KINDS: tuple[type[Any], ...] = (
    PatientCamera,
    PatientHead,
    PatientTracker,
    PatientGripper,
    PatientIo,
)
ARGUMENTS: dict[str, tuple[object, ...]] = {"set_exposure": (0.01,), "write": ({"lamp": True},)}


class Hanging:
    """A driver of any kind that never comes back from anything."""

    name = "eye"
    input_names = output_names = ("lamp",)

    def __getattr__(self, _: str) -> Callable[..., Any]:
        async def hangs(*_: object) -> None:
            await asyncio.Event().wait()

        return hangs


def _calls() -> list[tuple[type[Any], str]]:
    return [
        (kind, name)
        for kind in KINDS
        for name, _ in inspect.getmembers(kind, inspect.iscoroutinefunction)
        if not name.startswith("_")
    ]


@pytest.mark.parametrize(("kind", "name"), _calls(), ids=lambda one: getattr(one, "__name__", one))
async def test_every_call_has_an_end(kind: type[Any], name: str) -> None:
    device = kind(Hanging(), 0.01)
    with pytest.raises(ReplyTimeout, match="eye: its driver has not come back"):
        await getattr(device, name)(*ARGUMENTS.get(name, ()))


def test_what_is_asked_of_each_kind() -> None:
    assert len(_calls()) >= 2 * len(KINDS) + 10


@pytest.mark.parametrize("file", ["deck.toml", "antenna.toml", "insertion-pin.toml"])
def test_every_driver_of_a_cell_is_behind_such_a_layer(file: str) -> None:
    cell = Cell(shipped_cell(file), CELL_FILE.parent)
    for device in cell._by_path().values():
        behind: Any = device
        while not isinstance(behind, PatientDevice | PatientRobot):
            behind = vars(behind).get("_robot") or vars(behind)["_device"]
    cell.workers.close()
