"""An antenna cell without errors for the steps: an arm that is at once where it is sent, cameras
that show what is true, a gripper, a force sensor that feels the module. Tests say what goes wrong.
"""

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.clock import now_s
from cellctl.errors.gripper import PartLost
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import MountedCamera
from cellctl.processes.antenna_module.chain.schemes import DIFFERENCE
from cellctl.processes.antenna_module.drawings import Drawings, read_drawings
from cellctl.processes.antenna_module.facts import PluggingFacts
from cellctl.processes.antenna_module.looking import Eyes, Seen, nominal
from cellctl.processes.antenna_module.mated import connector_T_plug
from cellctl.processes.antenna_module.moves.moving import Mover
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.stations import antenna_recipes
from cellctl.processes.antenna_module.vision.measure import measure_marks
from cellctl.processes.antenna_module.vision.measurement import (
    ContactState,
)
from cellctl.processes.antenna_module.vision.plane import PlaneCalibration
from cellctl.records.run_recorder import RunRecorder
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.progress import ProgressBoard
from tests.rigs.antenna.exact_cell import JOINTS_RAD, SEEN
from tests.rigs.antenna.exact_cell import cell as exact_cell
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.guard import TinyGuard
from tests.unit.processes.antenna_module.steps.notes import Notes
from tests.unit.processes.antenna_module.steps.shown import connector_shown, seen_in

CONFIG = Path(__file__).parents[5] / "config"
FLANGE_T_CAM1 = pose_from_xyzabc((110.0, 0.0, -50.0, 0.0, 0.0, 0.0))
BASE_T_CAM2 = pose_from_xyzabc((500.0, 100.0, 50.0, 0.0, 0.0, 0.0))
TAUGHT: Mapping[str, RigidTransform] = {
    "home": pose_from_xyzabc((400.0, 0.0, 600.0, 0.0, 0.0, 180.0)),
    "tray_look": pose_from_xyzabc((340.0, 300.0, 410.0, 0.0, 0.0, 180.0)),
    "inspect_plug": pose_from_xyzabc((500.0, 100.0, 500.0, 0.0, 0.0, 180.0)),
    "socket_look": pose_from_xyzabc((390.0, -200.0, 410.0, 0.0, 0.0, 180.0)),
}
PLAY = pose_from_xyzabc((0.3, -0.2, 0.0, 0.4, 0.0, 0.0))
"""How the module settles in the fingers."""
_G_M_S2 = 9.80665


@cache
def _shipped() -> tuple[AntennaRecipe, Drawings]:
    """Recipe and drawings of the fake cell; both are frozen."""
    (recipe,) = antenna_recipes(shipped_cell("antenna.toml"))
    return recipe, read_drawings(recipe, CONFIG)


@dataclass
class Bench:
    """The cell; a test changes its truth before a step."""

    base_T_flange: RigidTransform = TAUGHT["home"]
    events: list[str] = field(default_factory=list)
    """Looks, moves by their kind, and what the gripper does."""
    visited: list[RigidTransform] = field(default_factory=list)
    """Where the arm was sent."""
    spoilt: dict[str, list[Exception]] = field(default_factory=dict)
    """What the next looks of this name raise."""
    bad_holes: dict[str, ContactState] = field(default_factory=dict)
    bad_pins: dict[str, ContactState] = field(default_factory=dict)
    notes: Notes = field(default_factory=Notes)
    guard: TinyGuard = field(default_factory=TinyGuard)
    base_T_socket: RigidTransform = field(init=False)
    base_T_connector: RigidTransform = field(init=False)
    """The plug of the module while it is not gripped."""
    flange_T_connector: RigidTransform = field(init=False)
    """The plug in the gripper."""
    held: bool = False
    mass_kg: float = 0.25
    lost: bool = False
    """The jaws have closed on nothing: the module fell out of them."""
    sideways_n: float = 0.0
    """What else the force sensor feels while the module is held."""

    def __post_init__(self) -> None:
        self.recipe, self.drawings = _shipped()
        self.base_T_connector = nominal(self.recipe.base_T_tray_plug) * pose_from_xyzabc(
            (0.6, -0.4, 0.03, 0.5, 0.0, 0.0)
        )
        self.base_T_socket = nominal(self.recipe.base_T_socket) * pose_from_xyzabc(
            (-0.5, 0.3, 0.0, 0.2, 0.0, 0.0)
        )
        self.flange_T_connector = pose_from_xyzabc(self.recipe.flange_T_plug) * PLAY
        self._hold(held=False)
        self.connector_T_top = pose_from_xyzabc(self.recipe.plug_T_top)

    # -- the run --------------------------------------------------------------------------------
    def run(self, **changes: object) -> PluggingRun:
        """A run in this cell; ``changes`` are those of the recipe."""
        recipe: AntennaRecipe = self.recipe.model_copy(update=changes)
        robot = SimpleNamespace(name="arm", state=self.state)
        arm = SimpleNamespace(
            robot=robot,
            guard=self.guard,
            sensor_name="force",
            flange_T_sensor=pose_from_xyzabc((0.0, 0.0, 30.0, 0.0, 0.0, 0.0)),
            zero_file=None,
        )
        cell = SimpleNamespace(
            arm=arm,
            gripper=self,
            camera_1="camera 1",
            camera_2="camera 2",
            workers=SimpleNamespace(run=_drawn),
            cell=SimpleNamespace(trips_awaited=_Awaited),
        )
        facts = SimpleNamespace(
            cell=cell,
            recipe=recipe,
            drawings=self.drawings,
            camera_1=SimpleNamespace(id="camera 1"),
            camera_2=SimpleNamespace(id="camera 2"),
            plug_cell=exact_cell(
                cam1=MountedCamera("hand-eye 1", "camera 1", UncertainPose(FLANGE_T_CAM1, SEEN)),
                cam2=MountedCamera("hand-eye 2", "camera 2", UncertainPose(BASE_T_CAM2, SEEN)),
                gripper=self.drawings.gripper.name,
                flange_T_marks=pose_from_xyzabc(recipe.flange_T_marks),
            ),
            scheme=replace(DIFFERENCE, taught=False),
            correction=None,
        )
        recorder = SimpleNamespace(
            phase=self.notes.phase,
            figure=self.notes.figure,
            figures=self.notes.figures_of,
            document=self.notes.document,
            measurement=self.notes.measurement,
            pose=self.notes.pose,
            artefact=self.notes.artefact,
        )
        return PluggingRun(
            facts=cast(PluggingFacts, facts),
            board=ProgressBoard(),
            recorder=cast(RunRecorder, recorder),
            safe_point=cast(Any, None),
            interruption=Interruption(),
            eyes=cast(Eyes, self),
            mover=cast(Mover, self),
            last_check=cast(Any, None),
        )

    def state(self) -> SimpleNamespace:
        return SimpleNamespace(base_T_flange=self.base_T_flange, joints_rad=JOINTS_RAD)

    # -- the arm --------------------------------------------------------------------------------
    async def to_taught(self, pose: str) -> None:
        self._go(pose, TAUGHT[pose])

    async def to_taught_over(self, pose: str) -> None:
        await self.to_taught(pose)

    async def to(self, base_T_flange: RigidTransform) -> None:
        self._go("move", base_T_flange)

    async def slowly_to(self, base_T_flange: RigidTransform) -> None:
        self._go("slowly", base_T_flange)

    def _go(self, kind: str, base_T_flange: RigidTransform) -> None:
        self.events.append(kind)
        self.visited.append(base_T_flange)
        self.base_T_flange = base_T_flange

    @property
    def heights_mm(self) -> list[float]:
        """Heights of the flange at every place that it was sent to."""
        return [float(pose.translation[2]) / MM for pose in self.visited]

    # -- the gripper and what the sensor feels --------------------------------------------------
    async def open(self) -> None:
        self.events.append("open")
        if self.held:
            self.base_T_connector = self.connector_now()
        self._hold(held=False)

    def feel(self, sideways_n: float) -> None:
        """The held module touches something."""
        self.sideways_n = sideways_n
        self._hold(held=True)

    async def close(self) -> None:
        self.events.append("close")
        self.flange_T_connector = self.base_T_flange.inv() * self.base_T_connector * PLAY
        self._hold(held=True)

    async def confirm_part(self) -> None:
        self.events.append("part?")
        if self.lost:
            raise PartLost("gripper: no part between the jaws")

    def _hold(self, *, held: bool) -> None:
        self.held = held
        force_n = [self.sideways_n, 0.0, self.mass_kg * _G_M_S2, 0.0, 0.0, 0.0]
        noise = np.random.default_rng(1).normal(0.0, 0.01, (200, 6))
        self.guard.raw = noise + (np.array(force_n) if held else 0.0)

    def connector_now(self) -> RigidTransform:
        """True ``base_T_connector`` of the plug."""
        return self.base_T_flange * self.flange_T_connector if self.held else self.base_T_connector

    def seated(self, base_T_flange: RigidTransform) -> None:
        """The gripper opens with the plug in its socket and the flange there."""
        self.base_T_connector = base_T_flange * self.flange_T_connector
        self._hold(held=False)

    # -- the cameras ----------------------------------------------------------------------------
    async def look(self, name: str, camera: str, measure: Callable[..., Any]) -> Seen[Any]:
        self.events.append(f"look {name}")
        if self.spoilt.get(name):
            raise self.spoilt[name].pop(0)
        assert isinstance(measure, partial)
        frame = self._found(camera, measure)
        return Seen(
            (frame,), (np.zeros((2, 2), np.uint8),), self.base_T_flange, JOINTS_RAD, now_s()
        )

    def _found(self, camera: str, measure: "partial[Any]") -> object:
        asked = measure.keywords
        plane: PlaneCalibration = asked["calibration"]
        base_T_camera = BASE_T_CAM2 if camera == "camera 2" else self.base_T_flange * FLANGE_T_CAM1
        seen = partial(seen_in, plane, base_T_camera)
        if measure.func is measure_marks:
            return seen(self.connector_now() * self.connector_T_top)
        if camera == "camera 1":
            return connector_shown(
                asked["connector"], seen(self.base_T_socket), None, self.bad_holes
            )
        marks = seen(self.base_T_flange * pose_from_xyzabc(self.recipe.flange_T_marks))
        plug = seen(self.connector_now())
        return connector_shown(asked["connector"], plug, marks, self.bad_pins)


def chain_plug(bench: Bench) -> RigidTransform:
    """``flange_T_plug`` of the held plug in the chain's frame."""
    return bench.flange_T_connector * connector_T_plug(bench.drawings.socket)


def nothing_swings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps need not wait until the arm is still, and readings of the force need no time."""

    async def still(_guard: object) -> None:
        return

    steps = "cellctl.processes.antenna_module.steps"
    for name in ("pick", "stand_off"):
        # By its name: the package offers the function under the name of the module.
        step = importlib.import_module(f"{steps}.{name}")
        monkeypatch.setattr(step, "settle", still)


class _Awaited:
    """``trips_awaited`` of a cell."""

    def __init__(self, sensor: str) -> None:
        assert sensor == "force"

    def __enter__(self) -> None:
        return

    def __exit__(self, *_reason: object) -> None:
        return


async def _drawn(*_arguments: object) -> bytes:
    return b"png"
