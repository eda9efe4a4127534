"""Recorded procedures of the process are computed anew from images, poses and touches."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.boards.board import CalibrationBoard, CameraView, Corners
from cellctl.calibration.checks import LimitCheck, evidence_to_record
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.single_camera.single_camera_result import SingleCameraResult
from cellctl.calibration.store.envelope import read_calibration
from cellctl.clock import now_s
from cellctl.errors.records.store import NotReplayable
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module import looking
from cellctl.processes.antenna_module.moves import reference_drive
from cellctl.processes.antenna_module.procedures import (
    board_drive,
    camera_intrinsics,
    replays,
    teach_reference,
    turn_tool,
)
from cellctl.processes.antenna_module.procedures.camera_intrinsics import calibrate_camera_on_cell
from cellctl.processes.antenna_module.procedures.camera_mounting import calibrate_mounting_on_cell
from cellctl.processes.antenna_module.process import AntennaModule
from cellctl.processes.antenna_module.settings import ArmSection
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.processes.antenna_module.vision.measurement import MeasuredMarks
from cellctl.runtime.procedure import ProcedureContext
from cellctl.vision.camera.lens import project
from tests.rigs.antenna.exact_cell import SEEN
from tests.rigs.calibration.hand_eye_views import (
    BASE_T_BOARD,
    FLANGE_T_CAMERA,
    disturbed,
    random_view,
)
from tests.rigs.procedure_record import Kept, differing
from tests.unit.processes.antenna_module.moves.reference_world import World
from tests.unit.processes.antenna_module.moves.reference_world import (
    drive as drive_past_references,
)
from tests.unit.processes.antenna_module.procedures.panel import (
    Panel,
    in_worker,
    orienting,
    touched,
    touching,
)

VIEWS = 20
NOT_SEEN = 4
"""The view in which the board is cut off."""
REPLAYS = AntennaModule.procedure_replays()


@cache
def camera_1() -> SingleCameraResult:
    record = read_calibration(Path("config/antenna-calibration"), "camera_1").record
    return SingleCameraResult.from_record(record)


@cache
def looks() -> list[tuple[RigidTransform, RigidTransform]]:
    """base_T_flange as reported and camera_T_board of every view."""
    rng = np.random.default_rng(0)
    seen = [random_view(rng) for _ in range(VIEWS)]
    return [(disturbed(rng, BASE_T_BOARD * one.inv() * FLANGE_T_CAMERA.inv()), one) for one in seen]


def find(image: Image, *, name: str, board: CalibrationBoard) -> CameraView | None:
    """Stands in for the detection: each image has the number of its view in each pixel."""
    number = int(image[0, 0])
    if number == NOT_SEEN:
        return None
    result = camera_1()
    pixels = project(result.camera.model, looks()[number][1].apply(result.board_m))
    return CameraView(name, Corners(np.arange(len(pixels)), pixels))


def calibrate(views: Sequence[CameraView], _board: object, size: tuple[int, int]) -> Any:
    """Stands in for the adjustment, which takes many seconds: it sees the middles of boards."""
    middles = {view.name: view.corners.pixels.mean(axis=0).tolist() for view in views}
    mean = float(np.mean(list(middles.values())))
    evidence = evidence_to_record("middles", (LimitCheck("mean", mean, 1e4, "px"),))
    record = {**evidence, "views": middles, "image_size": size}
    return SimpleNamespace(to_record=lambda: record, passed=True, warnings=())


class Drive:
    """Arm and camera I round the board; the arm arrives where it says that it is."""

    def __init__(self) -> None:
        self.number = 0
        self.name = "camera_1"

    async def to(self, target: object) -> None:
        if isinstance(target, int):
            self.number = target

    to_taught = to

    def state(self) -> SimpleNamespace:
        here = looks()[self.number][0]
        return SimpleNamespace(
            base_T_flange=here, joints_rad=np.zeros(6), time_s=now_s(),
            distance_to=lambda _pose: (0.0, 0.0),
        )  # fmt: skip

    async def grab(self) -> CameraImage:
        pixels = np.full((4, 6), self.number, np.uint8)
        return CameraImage(pixels, PixelFormat.MONO8, now_s(), self.number)

    async def serial_number(self) -> str:
        return "C1"

    @property
    def cell(self) -> AntennaCell:
        settings = SimpleNamespace(
            board="11x8", square_mm=1.5, board_distance_mm=250.0,
            arm=ArmSection.model_construct(absolute_error_mm=0.2),
        )  # fmt: skip
        workers = SimpleNamespace(
            run=in_worker, run_within=lambda _s, job, *of: in_worker(job, *of)
        )
        arm = SimpleNamespace(robot=self, guard=None)
        cell = SimpleNamespace(
            settings=settings, workers=workers, arm=arm, camera_1=self,
            flange_T_camera_1=FLANGE_T_CAMERA,
        )  # fmt: skip
        return cast(AntennaCell, cell)


@pytest.fixture
def drive(monkeypatch: pytest.MonkeyPatch) -> Drive:
    drive = Drive()

    async def done(*_of: object) -> None:
        return

    monkeypatch.setattr(looking, "settle", done)
    monkeypatch.setattr(board_drive, "Mover", lambda _cell: drive)
    monkeypatch.setattr(board_drive, "leave_stations", done)
    monkeypatch.setattr(board_drive, "swung_poses", lambda *_of: range(VIEWS))
    monkeypatch.setattr(board_drive, "_find", find)
    return drive


def with_view(kept: Kept, number: int, other: int) -> Kept:
    """As if another view had been recorded in place of one; both count from 1."""
    names = list(kept.images)
    return replace(kept, images=kept.images | {names[number - 1]: kept.images[names[other - 1]]})


async def test_a_camera_from_the_images_of_the_board(
    drive: Drive, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (camera_intrinsics, replays):
        monkeypatch.setattr(module, "calibrate_single_camera", calibrate)
    monkeypatch.setattr(camera_intrinsics, "single_camera_picture", lambda _: b"png")
    kept = Kept()
    outcome = await calibrate_camera_on_cell(
        drive.cell, Setup.EYE_IN_HAND, cast(ProcedureContext, kept)
    )
    assert list(kept.images)[:2] == [f"raw/view-{n}-frame-1.pgm.zst" for n in (1, 2)]
    assert len(kept.images) == VIEWS
    assert differing(REPLAYS[201], kept.run(outcome)) == {}
    # A view that today is another one, and one in which the board is found no more.
    found = differing(REPLAYS[201], with_view(kept, 2, 3).run(outcome))
    assert set(found) == {"mean", "views.view 2.1", "views.view 2.2"}
    found = differing(REPLAYS[201], with_view(kept, 2, NOT_SEEN + 1).run(outcome))
    assert np.isnan(found["views.view 2.1"])


async def test_where_a_camera_sits_from_images_and_poses(
    drive: Drive, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "cellctl.processes.antenna_module.procedures.camera_mounting.hand_eye_picture",
        lambda _: b"png",
    )
    snapshot = SimpleNamespace(require_instrument=lambda *_of: None, get=lambda _kind: camera_1())
    services: Any = SimpleNamespace(calibrations=SimpleNamespace(read_all=lambda *_of: snapshot))
    kept = Kept()
    outcome = await calibrate_mounting_on_cell(
        drive.cell, services, Setup.EYE_IN_HAND, cast(ProcedureContext, kept)
    )
    assert len(kept.given["looks"]) == VIEWS
    assert differing(REPLAYS[203], kept.run(outcome)) == {}
    found = differing(REPLAYS[203], with_view(kept, 2, NOT_SEEN + 1).run(outcome))
    assert 1e-5 < abs(found["flange_T_camera.matrix_mm.1.4"]) < 1.0
    kept.given["looks"][6]["base_T_flange"][0][3] += 2e-4
    found = differing(REPLAYS[203], kept.run(outcome))
    assert 1e-5 < max(abs(found[f"flange_T_camera.matrix_mm.{row}.4"]) for row in (1, 2, 3)) < 0.2


async def test_an_image_that_is_not_there_is_told(
    drive: Drive, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(camera_intrinsics, "calibrate_single_camera", calibrate)
    monkeypatch.setattr(camera_intrinsics, "single_camera_picture", lambda _: b"png")
    kept = Kept()
    outcome = await calibrate_camera_on_cell(
        drive.cell, Setup.EYE_IN_HAND, cast(ProcedureContext, kept)
    )
    del kept.images["raw/view-7-frame-1.pgm.zst"]
    with pytest.raises(NotReplayable, match=r"raw/view-7-.* is not in the record"):
        list(REPLAYS[201](kept.run(outcome)))


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    """Marks round the flange axis and a plate, in images that have the number of their look in
    each pixel."""
    world = World()

    def measure_marks(image: Image, **_as_expected: object) -> MeasuredMarks:
        number = int(image[0, 0])
        aside = RigidTransform.from_translation([int(image[0, 1]) * 1e-6, 0.0, 0.0])
        lies = aside * world.looks[number][1]
        return MeasuredMarks(UncertainPose(lies, SEEN), np.zeros((5, 2)), 10.0, 1.0)

    async def facts(*_of: object, **_how: object) -> object:
        drive = drive_past_references(world, [])
        facts = cast(Any, drive.facts)
        facts.required_plate, facts.calibrations = drive.plate, SimpleNamespace(find=lambda _: None)
        return facts

    async def done(*_of: object) -> None:
        return

    monkeypatch.setattr(looking, "measure_marks", measure_marks)
    monkeypatch.setattr(reference_drive, "Mover", lambda _cell: world)
    for procedure in (teach_reference, turn_tool):
        monkeypatch.setattr(procedure, "read_facts", facts)
        monkeypatch.setattr(procedure, "leave_stations", done)
        monkeypatch.setattr(procedure, "Mover", lambda _cell: world)
        monkeypatch.setattr(procedure, "eyes_of", lambda *_of: world)
    monkeypatch.setattr(teach_reference, "reference_picture", lambda *_of: b"png")
    monkeypatch.setattr(turn_tool, "turn_picture", lambda *_of: b"png")
    return world


def cell_of(world: World) -> AntennaCell:
    async def open_() -> None:
        return

    cell = SimpleNamespace(
        arm=SimpleNamespace(robot=world), gripper=SimpleNamespace(open=open_),
        workers=SimpleNamespace(run=in_worker),
    )  # fmt: skip
    return cast(AntennaCell, cell)


def pictures(world: World) -> dict[str, Image]:
    """The images of all looks."""
    return {
        looking.image_file(name): np.array([[number, 0]], np.uint8)
        for number, (name, _) in enumerate(world.looks)
    }


async def test_a_reference_from_the_images_of_both_cameras(world: World) -> None:
    kept = Kept()
    outcome = await teach_reference.teach_reference_on_cell(
        cell_of(world), cast(Any, None), cast(Any, SimpleNamespace(taught_looks=8)),
        cast(Any, SimpleNamespace(calibrations=None)), cast(ProcedureContext, kept),
    )  # fmt: skip
    kept.images = pictures(world)
    assert len(kept.images) == 8 + 8 + 1
    assert differing(REPLAYS[205], kept.run(outcome)) == {}
    # Two micrometres in one of eight images of the plate.
    kept.images["raw/reference-3-above-frame-1.pgm.zst"][0, 1] = 2
    found = differing(REPLAYS[205], kept.run(outcome))
    moved_mm = [found.get(f"plate_in_camera_1_mm.{axis}", 0.0) for axis in (1, 2)]
    assert np.linalg.norm(moved_mm) == pytest.approx(2e-3 / 8, rel=0.01)
    assert "axis_in_camera_2_mm.1" not in found


async def test_marks_beside_the_axis_from_the_images_of_camera_ii(world: World) -> None:
    recipe: Any = SimpleNamespace(flange_T_marks=(0.3, -0.2, 200.0, 0.0, 0.0, 0.0))
    kept = Kept()
    outcome = await turn_tool.turn_tool_on_cell(
        cell_of(world), recipe, cast(Any, SimpleNamespace(calibrations=None)),
        cast(ProcedureContext, kept),
    )  # fmt: skip
    kept.images = pictures(world)
    assert len(kept.images) == turn_tool.LOOKS
    assert differing(REPLAYS[207], kept.run(outcome)) == {}
    kept.images["raw/turn-4-frame-1.pgm.zst"][0, 1] = 20
    found = differing(REPLAYS[207], kept.run(outcome))
    assert found["residual rms"] > 1e-3
    assert 1e-4 < abs(found["marks beside their drawing"]) < 0.02


async def test_a_tool_from_its_touches(monkeypatch: pytest.MonkeyPatch) -> None:
    panel = Panel(poses=touching() + orienting())
    outcome = await touched(panel, monkeypatch)
    assert differing(REPLAYS[208], panel.run(outcome)) == {}
    panel.given["base_T_flange"][2][2][3] += 1e-4
    found = differing(REPLAYS[208], panel.run(outcome))
    assert 1e-3 < found["residuals_mm.3"] < 0.1
    moved_mm = [off for name, off in found.items() if name.startswith("flange_T_tool.matrix_mm")]
    assert max(map(abs, moved_mm)) > 1e-3


def test_every_camera_has_its_recomputation() -> None:
    names = ["camera_1", "camera_2", "flange_T_cam1", "base_T_cam2"]
    replayed = [cast(partial[Any], REPLAYS[number]) for number in range(201, 205)]
    assert [one.keywords["name"] for one in replayed] == names
