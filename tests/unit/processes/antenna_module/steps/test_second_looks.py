"""A picture that chance has spoilt is taken again, once in a run; one of a bad part is not."""

import importlib
from dataclasses import replace

import pytest

from cellctl.errors.force import ForceLimitExceeded
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorMisplaced,
    ConnectorMissing,
    ConnectorUncertain,
    ContactBent,
    ContactHidden,
    ContactMissing,
    MarksMissing,
)
from cellctl.processes.antenna_module.faults.plugging import SocketUnsound
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import HeldModule, Picked, PlugInspected
from tests.unit.processes.antenna_module.steps.bench import TAUGHT, Bench

# By their names: the package offers the functions under the names of the modules.
STEPS = "cellctl.processes.antenna_module.steps"
inspect, locate = (
    importlib.import_module(f"{STEPS}.{name}") for name in ("inspect_plug", "locate_socket")
)
GRIP = pose_from_xyzabc((450.0, 300.0, 360.0, 0.0, 0.0, 180.0))


def picked(bench: Bench) -> Picked:
    bench.feel(sideways_n=0.0)
    bench.base_T_flange = TAUGHT["inspect_plug"]
    module = HeldModule(0.25, bench.guard.raw[0, :3], -0.16)
    run = bench.run()
    run.board.update(step=40, step_label="inspect plug")
    return Picked(run, module, GRIP)


async def inspected(bench: Bench) -> PlugInspected:
    seen: PlugInspected = await inspect.inspect_plug(picked(bench))
    return seen


@pytest.mark.parametrize("spoilt", [ConnectorUncertain, ConnectorMissing, MarksMissing])
async def test_a_spoilt_picture_of_the_plug_is_taken_again(
    bench: Bench, spoilt: type[Exception]
) -> None:
    bench.spoilt = {"plug": [spoilt("glare")]}
    await inspected(bench)
    assert bench.events == ["inspect_plug", "look plug", "move", "move", "look plug-again"]
    # Straight up and back to the same place, where constant errors cancel.
    up, back = bench.heights_mm[-2:]
    assert up - back == pytest.approx(5.0)
    assert bench.visited[-1] is bench.visited[0]
    second = bench.notes.documents[keys.SECOND_LOOK]
    assert second["look"] == "plug"
    assert "glare" in second["first"]


async def test_a_second_spoilt_picture_ends_the_run_and_tells_of_the_first(bench: Bench) -> None:
    bench.spoilt = {
        "plug": [ConnectorUncertain("4.2 µm")],
        "plug-again": [MarksMissing("2 spots")],
    }
    with pytest.raises(MarksMissing) as raised:
        await inspected(bench)
    assert any("4.2 µm" in note for note in raised.value.__notes__)
    assert bench.held


async def test_there_is_one_second_look_for_plug_and_socket_together(bench: Bench) -> None:
    bench.spoilt = {
        "plug": [ConnectorUncertain("4.2 µm")],
        "socket-1": [ConnectorUncertain("3.9 µm")],
    }
    seen = await inspected(bench)
    with pytest.raises(ConnectorUncertain, match=r"3\.9"):
        await locate.locate_socket(seen)
    assert bench.events[-1] == "look socket-1"


async def test_a_spoilt_picture_of_the_socket_is_taken_again(bench: Bench) -> None:
    bench.spoilt = {"socket-2": [ConnectorUncertain("3.9 µm")]}
    located = await locate.locate_socket(await inspected(bench))
    assert len(located.looks.sockets) == 2
    assert bench.events[-1] == "look socket-2-again"
    assert bench.notes.figures[keys.SECOND_LOOKS] == 1


async def test_what_a_picture_says_of_the_part_is_not_asked_twice(bench: Bench) -> None:
    bench.spoilt = {"socket-found": [ConnectorMisplaced("2.4 mm")]}
    with pytest.raises(ConnectorMisplaced):
        await locate.locate_socket(await inspected(bench))
    assert "look socket-found-again" not in bench.events


async def test_a_blocked_hole_is_the_fault_of_the_socket(bench: Bench) -> None:
    bench.bad_holes = {"7": "hidden"}
    with pytest.raises(SocketUnsound, match="7 hidden"):
        await locate.locate_socket(await inspected(bench))
    # Dirt may have been a reflection: that one was looked at again.
    assert bench.events[-1] == "look socket-found-again"
    assert keys.SOCKET_PICTURE in bench.notes.artefacts
    assert SocketUnsound not in AntennaModule.spoiled_by


@pytest.mark.parametrize(
    ("state", "fault", "looks"),
    [("missing", ContactMissing, 1), ("bent", ContactBent, 1), ("hidden", ContactHidden, 2)],
)
async def test_a_module_with_a_bad_contact_goes_back_onto_its_tray(
    bench: Bench, state: str, fault: type[Exception], looks: int
) -> None:
    bench.bad_pins = {"4": state}  # type: ignore[dict-item]
    with pytest.raises(fault, match="4"):
        await inspected(bench)
    assert sum(event.startswith("look") for event in bench.events) == looks
    # Across over the tray as high as it was, down, let go, up.
    assert bench.events[-5:] == ["move", "move", "slowly", "open", "slowly"]
    assert bench.heights_mm[-4:] == pytest.approx([500.0, 420.0, 360.3, 420.0])
    assert not bench.held
    assert bench.notes.phases == ["46 put back", "40 inspect plug"]
    assert keys.PLUG_PICTURE in bench.notes.artefacts


def test_a_missing_or_bent_contact_makes_the_module_bad_and_dirt_does_not() -> None:
    assert {ContactMissing, ContactBent} <= AntennaModule.spoiled_by
    assert ContactHidden not in AntennaModule.spoiled_by


async def test_a_touch_while_a_bad_module_is_put_back_ends_it_held(bench: Bench) -> None:
    bench.bad_pins = {"4": "bent"}
    held = picked(bench)

    class Touched:
        to, to_taught_over = bench.to, bench.to_taught

        async def slowly_to(self, _pose: object) -> None:
            raise ForceLimitExceeded("5.2 N")

    touched = replace(held, run=replace(held.run, mover=Touched()))  # type: ignore[arg-type]
    with pytest.raises(ForceLimitExceeded) as raised:
        await inspect.inspect_plug(touched)
    assert isinstance(raised.value.__context__, ContactBent)
    assert bench.held
    assert bench.events[-1] == "move"
