"""A whole cell in memory, with a true world behind its heads."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.payload import IdentifiedPayload
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.devices import Cell
from cellctl.cell.robot_layers.noted_robot import RobotNotes
from cellctl.cell.robot_layers.slowed_robot import MaintenancePace
from cellctl.cell.run_notes import RunNotes
from cellctl.cell.stereo_station import StereoStation
from cellctl.cell.time_limits import TimeLimits
from cellctl.clock import now_s, utc_now
from cellctl.config import CellConfig
from cellctl.errors import CellError
from cellctl.errors.internal import WorkerDied
from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import StereoPair
from cellctl.packml.unit_command import Options, Source, UnitCommand
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS, PAYLOAD
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.processes.deck_to_frame.poses.part_measurer import (
    HeadGeometry,
    PartMeasurement,
    SeenPair,
    deck_in_frame,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.run_facts import RunFacts
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.processes.deck_to_frame.stations import DeckCell, FrameMemory
from cellctl.vision.features.feature_file import FeatureFile, read_features
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.chi_square import ChiSquare
from cellctl.vision.registration.measured_points import MeasuredPoints
from cellctl.vision.registration.part_pose import PartPose
from cellctl.vision.registration.relative_pose import RelativePose
from tests.contracts.inprocess.stereo_camera import InProcessHead
from tests.contracts.inprocess.target_tracker import InProcessTracker
from tests.rigs.shipped import shipped_cell
from tests.unit.calibration.store.shipped import REQUIRED, renew_calibrations
from tests.unit.cell.guard import TinyGuard
from tests.unit.cell.robots import StillRobot

ROOT = Path(__file__).parents[3]
CELL_FILE = ROOT / "config" / "deck.toml"
HEADS = {"head_1": "FH-0001", "head_2": "FH-0002"}
SIGMA = np.repeat([2e-6, 5e-6], 3)


class Head(InProcessHead):
    """A head with the serial number of its calibration."""

    def __init__(self, name: str, serial: str) -> None:
        super().__init__(name)
        self.serial = serial

    async def serial_number(self) -> str:
        self._check()
        return self.serial


class InlineWorkers:
    """Runs in the loop what a worker process would run; a test may put answers in its place."""

    def __init__(self) -> None:
        self.answers: dict[str, Callable[..., Any]] = {}
        self.ran: list[str] = []
        self.died = False

    async def run(self, function: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        self.ran.append(function.__name__)
        return self.answers.get(function.__name__, function)(*args, **kwargs)

    async def run_within(
        self, _patience_s: float, function: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        return await self.run(function, *args, **kwargs)

    async def check(self) -> None:
        if self.died:
            raise WorkerDied("killed")

    def revive(self) -> None:
        self.died = False

    def close(self) -> None:
        self.ran.append("closed")


@dataclass
class World:
    """Where things really are."""

    base_T_frame: RigidTransform
    flange_T_deck: RigidTransform
    robot_error: RigidTransform = field(default_factory=RigidTransform.identity)
    """Error of the flange, in its own frame, that the encoders do not see."""
    sigma: Array = field(default_factory=lambda: SIGMA)


class CellInMemory:
    """Has what ``Cell`` has."""

    stop_motion: Any = Cell.stop_motion
    rearm: Any = Cell.rearm
    health_checks: Any = Cell.health_checks
    incidents: Any = Cell.incidents
    ask_silent_devices: Any = Cell.ask_silent_devices
    _disarm_where_robots_stand: Any = Cell._disarm_where_robots_stand
    connect: Any = Cell.connect
    disconnect: Any = Cell.disconnect
    stereo_station: Any = Cell.stereo_station
    guarded_robot: Any = Cell.guarded_robot
    trips_awaited: Any = Cell.trips_awaited
    awaits_trips: Any = Cell.awaits_trips
    _by_path: Any = Cell._by_path

    def __init__(self, config: CellConfig, folder: Path) -> None:
        self.config, self.folder = config, folder
        self.main, self.aux_1, self.aux_2 = map(StillRobot, ("main", "aux_1", "aux_2"))
        self.robots = {robot.name: robot for robot in (self.main, self.aux_1, self.aux_2)}
        self.stereo_cameras = {name: Head(name, serial) for name, serial in HEADS.items()}
        self.tracker = InProcessTracker("tracker", {})
        self.trackers = {"tracker": self.tracker}
        self.cameras: dict[str, Any] = {}
        self.grippers: dict[str, Any] = {}
        self.digital_ios: dict[str, Any] = {}
        self.guard = TinyGuard()
        self.guards = {"force": self.guard}
        self.main.watched_by = self.guard
        self.workers = InlineWorkers()
        self.robot_notes = RobotNotes()
        self.run_notes = RunNotes()
        self.pace = MaintenancePace()
        self.time_limits = TimeLimits()
        self.connected = True
        self.zero_folder: Path | None = None
        self.unanswered: dict[str, CellError] = {}
        self.unstopped: dict[str, BaseException] = {}
        self._awaited_trips: set[str] = set()

    @property
    def head_1(self) -> StereoStation:
        station: StereoStation = self.stereo_station("head_1")
        return station

    @property
    def head_2(self) -> StereoStation:
        station: StereoStation = self.stereo_station("head_2")
        return station

    @property
    def heads(self) -> tuple[StereoStation, StereoStation]:
        return self.head_1, self.head_2


@dataclass
class Bench:
    """The cell, its true world and its calibrations."""

    cell: CellInMemory
    world: World
    calibrations: CalibrationStore
    station: RigidTransform
    """Nominal ``base_T_frame``."""
    grip: RigidTransform
    """Nominal ``flange_T_deck``."""
    memory: FrameMemory = field(default_factory=FrameMemory)

    @property
    def as_cell(self) -> Cell:
        return cast(Cell, self.cell)

    @property
    def recipe(self) -> DeckRecipe:
        return cast(DeckRecipe, self.cell.config.recipes[0])

    @property
    def settings(self) -> DeckSettings:
        return cast(DeckSettings, self.cell.config.processes["deck-to-frame"])

    @property
    def deck(self) -> DeckCell:
        """The devices in the roles of the process."""
        return DeckCell.of(self.as_cell, self.recipe, self.memory)

    def facts(self, **changes: Any) -> RunFacts:
        """Facts of a run with the shipped recipe."""
        frame, deck = self.features()
        snapshot = self.snapshot()
        values: dict[str, Any] = {
            "cell": self.deck,
            "recipe": self.recipe,
            "calibrations": snapshot,
            "geometry": CalibrationSet.of(snapshot),
            "payload": IdentifiedPayload(snapshot.get(PAYLOAD).gravity_compensation, 200.0),
            "commissioned": Commissioned(),
            "frame_features": frame,
            "deck_features": deck,
        }
        return RunFacts(**(values | changes))

    def flange_over_seat(self, height_m: float) -> RigidTransform:
        """Nominal flange pose with the deck so high above its seat."""
        recipe = self.recipe
        up = RigidTransform.from_translation([0.0, 0.0, recipe.deck_thickness_mm / 1e3 + height_m])
        return self.station * up * self.grip.inv()

    def base_T_c1(self) -> RigidTransform:
        """Head I as calibrated."""
        return self.geometry().base_T_c1.pose

    def snapshot(self) -> CalibrationSnapshot:
        """What production requires."""
        return self.calibrations.read_all(REQUIRED, utc_now())

    def geometry(self) -> CalibrationSet:
        """Where everything is, as calibrated."""
        return CalibrationSet.of(self.snapshot())

    def features(self) -> tuple[FeatureFile, FeatureFile]:
        recipe, folder = self.recipe, CELL_FILE.parent
        return (
            read_features(folder / recipe.frame_features),
            read_features(folder / recipe.deck_features),
        )


def make_bench(tmp_path: Path) -> Bench:
    """Everything nominal but frame and grip, which are off by a few millimetres."""
    folder = tmp_path / "calibration"
    renew_calibrations(folder)
    config = shipped_cell(CELL_FILE.name)
    config = config.model_copy(update={"calibration_dir": str(folder)})
    cell = CellInMemory(config, CELL_FILE.parent)
    for head in cell.heads:
        cast(InProcessHead, head.camera)._connected = True
    cell.tracker._connected = True
    recipe = cast(DeckRecipe, config.recipes[0])
    station = pose_from_xyzabc(recipe.base_T_frame)
    grip = pose_from_xyzabc(recipe.flange_T_deck)
    world = World(
        base_T_frame=station * pose_from_xyzabc([2.0, -1.5, 0.0, 0.2, 0.0, 0.0]),
        flange_T_deck=grip * pose_from_xyzabc([1.0, -2.0, 0.5, -0.3, 0.05, 0.02]),
        robot_error=pose_from_xyzabc([0.3, -0.2, 0.1, 0.02, -0.01, 0.01]),
    )
    bench = Bench(cell, world, CalibrationStore(folder, CALIBRATIONS), station, grip)
    teach(bench)
    return bench


def teach(bench: Bench) -> None:
    poses = bench.cell.config.robots["main"].poses_deg
    bench.cell.main.taught = [
        (np.radians(poses["home"]), RigidTransform.from_translation([1.5, 0.0, 1.8])),
        (np.radians(poses["deck_measure"]), bench.flange_over_seat(0.05)),
    ]


@dataclass
class TruthMeasurer:
    """Stands in for ``PartMeasurer``: sees the true world, exactly."""

    bench: Bench
    geometry: HeadGeometry
    base_T_c1: RigidTransform
    measured: list[str] = field(default_factory=list)
    frames: list[int] = field(default_factory=list)
    seen: list[SeenPair] = field(default_factory=list)

    def deck_in_frame(self, frame: PartPose, deck: PartPose) -> RelativePose:
        return deck_in_frame(frame, deck, self.geometry, "paper")

    async def measure(
        self, features: FeatureFile, c1_T_part: RigidTransform, *, frames: int = 2, **_: Any
    ) -> PartMeasurement:
        world, flange = self.bench.world, self.bench.cell.main.state().base_T_flange
        deck = any(hole.kind == "countersink" for hole in features.holes)
        self.measured.append("deck" if deck else "frame")
        self.frames.append(frames)
        base_T_part = world.base_T_frame
        if deck:
            base_T_part = flange * world.robot_error * world.flange_T_deck
        return measurement(self.base_T_c1.inv() * base_T_part, flange, features, world.sigma)


def measurement(
    c1_T_part: RigidTransform, base_T_flange: RigidTransform, features: FeatureFile, sigma: Array
) -> PartMeasurement:
    covariance = np.diag(sigma**2)
    names = tuple(hole.name for hole in features.holes)
    found = PairMeasurement("default", ())
    pose = PartPose(
        UncertainPose(c1_T_part, covariance), covariance, covariance, names,
        np.zeros((len(names), 3)), np.zeros(6), (), ChiSquare(12.0, 12),
        MeasuredPoints.seen(found, None, None, ()),
    )  # fmt: skip
    image = np.zeros((4, 6), np.uint8)
    pair = StereoPair(image, image, now_s(), 1)
    return PartMeasurement(pose, (found, found), (pair, pair), 2, base_T_flange)


def start_command(serial: str = "SAT-0001", *, options: int = 0, **changes: Any) -> UnitCommand:
    """Start of recipe 1 in Production, by the line."""
    values: dict[str, Any] = {"source": Source.LINE, "unit_mode": 1, "cntrl_cmd": 2, "recipe_id": 1}
    return UnitCommand(serial=serial, options=Options(options), **(values | changes))
