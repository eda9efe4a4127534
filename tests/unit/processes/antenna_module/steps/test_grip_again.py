"""A badly gripped module is put back and gripped again, once; moves and looks are scripted."""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.force import ForceLimitExceeded
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.faults.connector import ConnectorMisplaced, ContactBent
from cellctl.processes.antenna_module.faults.plugging import GrippedOffTwice
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import ModuleFound, Picked
from cellctl.runtime.progress import ProgressBoard

# By their names: the package offers the functions under the names of the modules.
STEPS = "cellctl.processes.antenna_module.steps"
again = importlib.import_module(f"{STEPS}.grip_again")
inspect = importlib.import_module(f"{STEPS}.inspect_plug")

GRIP = pose_from_xyzabc((450.0, 300.0, 360.0, 0.0, 0.0, 180.0))
OVER_CAMERA_2 = pose_from_xyzabc((500.0, 100.0, 500.0, 0.0, 0.0, 180.0))
APPROACH_MM = 60.0
FIRST = ConnectorMisplaced("2.50 mm from where it should be")
SECOND = ConnectorMisplaced("2.10 mm from where it should be")


class LookedAtAll(Exception):
    """Ends the step where its picture would be evaluated."""


@dataclass
class Rig:
    """A run that notes what happens to it."""

    events: list[str] = field(default_factory=list)
    heights_mm: list[float] = field(default_factory=list)
    documents: dict[str, Any] = field(default_factory=dict)
    looks: list[Exception | None] = field(default_factory=list)
    """What the next looks at the plug raise; None for a good one."""
    touch: Exception | None = None
    """What the slow way down to the tray raises."""
    board: ProgressBoard = field(default_factory=ProgressBoard)

    def picked(self) -> Picked:
        self.board.update(step=40, step_label="inspect plug")
        state = SimpleNamespace(base_T_flange=OVER_CAMERA_2)
        run = SimpleNamespace(
            board=self.board,
            recorder=self,
            mover=self,
            recipe=SimpleNamespace(grip_approach_mm=APPROACH_MM),
            cell=SimpleNamespace(
                arm=SimpleNamespace(robot=SimpleNamespace(state=lambda: state)), gripper=self
            ),
        )
        return Picked(cast(PluggingRun, run), 0.25, np.zeros(3), GRIP)

    async def phase(self, number: int, label: str) -> None:
        self.events.append(f"{number} {label}")

    async def document(self, key: str, content: Mapping[str, Any]) -> None:
        self.documents[key] = content

    async def figure(self, key: str, value: float, unit: str) -> None:
        self.events.append(f"{key} = {value:g}{unit}")

    async def to(self, pose: RigidTransform) -> None:
        self.heights_mm.append(float(pose.translation[2]) / MM)

    async def slowly_to(self, pose: RigidTransform) -> None:
        await self.to(pose)
        if self.touch is not None:
            raise self.touch

    async def open(self) -> None:
        self.events.append(f"open at {self.heights_mm[-1]:.1f}")

    async def look(self, _run: object, images: str) -> Any:
        self.events.append(images)
        fault = self.looks.pop(0)
        if fault is not None:
            raise fault
        return SimpleNamespace(frames=[self])

    async def find(self, run: PluggingRun, images: str) -> ModuleFound:
        self.events.append(images)
        return ModuleFound(run, RigidTransform.identity())

    async def pick(self, found: ModuleFound) -> Picked:
        self.events.append("pick")
        return Picked(found.run, 0.25, np.zeros(3), GRIP)


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    made = Rig()

    def evaluated(_frame: object) -> None:
        raise LookedAtAll

    monkeypatch.setattr(inspect, "_look", made.look)
    monkeypatch.setattr(inspect, "require_sound", evaluated)
    monkeypatch.setattr(again, "find_on_tray", made.find)
    monkeypatch.setattr(again, "pick", made.pick)
    return made


async def test_a_good_grip_is_looked_at_once(rig: Rig) -> None:
    rig.looks = [None]
    with pytest.raises(LookedAtAll):
        await inspect.inspect_plug(rig.picked())
    assert rig.events == ["plug", f"{keys.REGRIPS} = 0"]
    assert rig.documents == {}


async def test_a_bad_grip_is_put_back_and_gripped_again(rig: Rig) -> None:
    rig.looks = [FIRST, None]
    with pytest.raises(LookedAtAll):
        await inspect.inspect_plug(rig.picked())
    assert rig.events == [
        "plug",
        "45 grip again",
        "open at 360.3",
        "tray-again",
        "pick",
        "40 inspect plug",
        "plug-again",
        f"{keys.REGRIPS} = 1",
    ]
    # Across as high as the arm was, then down; after opening up again.
    assert rig.heights_mm == pytest.approx([500.0, 420.0, 360.3, 420.0])
    assert rig.documents == {keys.REGRIP: {"first_grip": FIRST.detail}}
    assert (rig.board.current.step, rig.board.current.step_label) == (40, "inspect plug")


async def test_there_is_no_third_grip(rig: Rig) -> None:
    rig.looks = [FIRST, SECOND]
    with pytest.raises(GrippedOffTwice, match=r"first 2\.50 mm .*; then 2\.10 mm"):
        await inspect.inspect_plug(rig.picked())
    assert rig.events.count("pick") == 1


async def test_a_bad_contact_is_no_reason_to_grip_again(rig: Rig) -> None:
    rig.looks = [ContactBent("4")]
    with pytest.raises(ContactBent):
        await inspect.inspect_plug(rig.picked())
    assert rig.events == ["plug"]


async def test_a_touch_on_the_way_back_ends_it_with_the_module_held(rig: Rig) -> None:
    rig.looks, rig.touch = [FIRST], ForceLimitExceeded("5.2 N")
    with pytest.raises(ForceLimitExceeded):
        await inspect.inspect_plug(rig.picked())
    assert rig.events == ["plug", "45 grip again"]
