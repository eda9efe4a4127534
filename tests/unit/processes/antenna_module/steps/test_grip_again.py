"""A badly gripped module is put back and gripped again, once."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from cellctl.errors.force import ForceLimitExceeded
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import ConnectorMisplaced
from cellctl.processes.antenna_module.faults.plugging import GrippedOffTwice
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.state import HeldModule, Picked
from tests.unit.processes.antenna_module.steps.bench import TAUGHT, Bench, nothing_swings

# By their names: the package offers the functions under the names of the modules.
STEPS = "cellctl.processes.antenna_module.steps"
inspect = importlib.import_module(f"{STEPS}.inspect_plug")

GRIP = pose_from_xyzabc((450.0, 300.0, 360.0, 0.0, 0.0, 180.0))
FIRST = ConnectorMisplaced("2.50 mm from where it should be")
SECOND = ConnectorMisplaced("2.10 mm from where it should be")


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    nothing_swings(monkeypatch)


def picked(bench: Bench) -> Picked:
    """The state over camera II with a module in the gripper."""
    bench.base_T_flange = TAUGHT["inspect_plug"]
    bench.feel(sideways_n=0.0)
    run = bench.run()
    run.board.update(step=40, step_label="inspect plug")
    return Picked(run, HeldModule(0.25, np.zeros(3), -0.16), GRIP)


async def test_a_good_grip_is_looked_at_once(bench: Bench) -> None:
    await inspect.inspect_plug(picked(bench))
    assert bench.events == ["inspect_plug", "look plug"]
    assert bench.notes.figures[keys.REGRIPS] == 0
    assert keys.REGRIP not in bench.notes.documents


async def test_a_bad_grip_is_put_back_and_gripped_again(bench: Bench) -> None:
    bench.spoilt = {"plug": [FIRST]}
    held = picked(bench)
    seen = await inspect.inspect_plug(held)
    assert bench.events == [
        "inspect_plug", "look plug",
        "move", "move", "slowly", "open", "slowly",
        "tray_look", "look tray-again-1", "move", "look tray-again-2",
        "move", "slowly", "close", "slowly", "part?",
        "inspect_plug", "look plug-again",
    ]  # fmt: skip
    # Across as high as the arm was, then down; after opening up again.
    assert bench.heights_mm[1:5] == pytest.approx([500.0, 420.0, 360.3, 420.0])
    assert bench.notes.documents[keys.REGRIP] == {"first_grip": FIRST.detail}
    assert bench.notes.figures[keys.REGRIPS] == 1
    assert bench.notes.phases == ["45 grip again", "40 inspect plug"]
    current = held.run.board.current
    assert (current.step, current.step_label) == (40, "inspect plug")
    # Weighed and measured anew: nothing of the first grip goes on.
    assert seen.module is not held.module
    assert seen.module.mass_kg == pytest.approx(0.25, abs=1e-3)


async def test_there_is_no_third_grip(bench: Bench) -> None:
    bench.spoilt = {"plug": [FIRST], "plug-again": [SECOND]}
    with pytest.raises(GrippedOffTwice, match=r"first 2\.50 mm .*; then 2\.10 mm"):
        await inspect.inspect_plug(picked(bench))
    assert bench.events.count("close") == 1
    assert bench.held


async def test_a_touch_on_the_way_back_ends_it_with_the_module_held(bench: Bench) -> None:
    bench.spoilt = {"plug": [FIRST]}
    held = picked(bench)

    class Touched:
        to, to_taught_over = bench.to, bench.to_taught

        async def slowly_to(self, _pose: object) -> None:
            raise ForceLimitExceeded("5.2 N")

    touched = replace(held, run=replace(held.run, mover=Touched()))  # type: ignore[arg-type]
    with pytest.raises(ForceLimitExceeded):
        await inspect.inspect_plug(touched)
    assert bench.held
    assert bench.events[-1] == "move"
