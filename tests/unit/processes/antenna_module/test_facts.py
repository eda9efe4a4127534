"""What a run refuses before anything moves, with the shipped calibrations of the fake cell."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from shutil import copytree
from types import SimpleNamespace
from typing import Any, cast

import pytest

from cellctl.calibration.store.store import CalibrationStore
from cellctl.config.load import load_cell
from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationMissing, CalibrationRecordInvalid
from cellctl.errors.config import ConfigInvalid
from cellctl.processes.antenna_module.calibrations import CALIBRATIONS
from cellctl.processes.antenna_module.facts import PluggingFacts, read_facts
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether
from cellctl.processes.antenna_module.stations import AntennaCell, antenna_recipes
from cellctl.sealed_json import content_id
from cellctl.vision.camera.single_camera import single_camera_from_json

CONFIG = Path(__file__).parents[4] / "config"


class Folder:
    """A copy of cell file, drawings and calibrations."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.serial_numbers = {"camera_1": "FC-0011", "camera_2": "FC-0012"}
        for name in ("connectors", "antenna-calibration"):
            copytree(CONFIG / name, path / name)
        text = (CONFIG / "antenna.toml").read_text(encoding="utf-8")
        (path / "antenna.toml").write_text(text, encoding="utf-8")

    def replace(self, file: str, old: str, new: str) -> None:
        text = (self.path / file).read_text(encoding="utf-8")
        assert old in text
        (self.path / file).write_text(text.replace(old, new, 1), encoding="utf-8")

    def record(self, kind: str) -> dict[str, Any]:
        """The content of a stored calibration."""
        path = self.path / "antenna-calibration" / f"{kind}.json"
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return content

    def store(self, kind: str, content: dict[str, Any]) -> None:
        """Store a calibration as it would have been: with an identity of its own."""
        plain = {key: value for key, value in content.items() if key != "id"}
        path = self.path / "antenna-calibration" / f"{kind}.json"
        path.write_text(json.dumps({"id": content_id(plain), **plain}), encoding="utf-8")

    async def facts(self) -> PluggingFacts:
        config = load_cell(self.path / "antenna.toml")
        (recipe,) = antenna_recipes(config)
        state = SimpleNamespace(speed_override_ratio=1.0)
        cell = SimpleNamespace(
            cell=SimpleNamespace(folder=self.path),
            arm=SimpleNamespace(robot=SimpleNamespace(name="arm", state=lambda: state)),
            settings=config.processes["antenna-module"],
            **{name: self._camera(name) for name in self.serial_numbers},
        )
        store = CalibrationStore(self.path / "antenna-calibration", CALIBRATIONS)
        return await read_facts(cast(AntennaCell, cell), recipe, store, CALIBRATIONS)

    def _camera(self, name: str) -> SimpleNamespace:
        async def serial_number() -> str:
            return self.serial_numbers[name]

        return SimpleNamespace(serial_number=serial_number)


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


async def test_the_shipped_calibrations_belong_together(folder: Folder) -> None:
    facts = await folder.facts()
    assert facts.correction is not None
    assert facts.reference is not None
    assert facts.correction.made_with.gripper == facts.drawings.gripper.name == "gripper"


async def test_a_file_may_be_renamed(folder: Folder) -> None:
    """What belongs to a gripper is known by the name in its drawing, not by that of the file."""
    drawings = folder.path / "connectors"
    (drawings / "gripper.toml").rename(drawings / "marks.toml")
    folder.replace("antenna.toml", "connectors/gripper.toml", "connectors/marks.toml")
    assert (await folder.facts()).correction is not None


async def test_limits_of_a_drawing_may_change(folder: Folder) -> None:
    """What was taught is a place; forces, tolerances and words are nothing of it."""
    pins = "connectors/micro-d-15-pins.toml"
    folder.replace(pins, "true_position_mm = ", "true_position_mm = 0.5e-2 # was ")
    assert (await folder.facts()).correction is not None


async def test_a_correction_of_an_earlier_version_knows_no_drawings(folder: Folder) -> None:
    content = folder.record("plug_correction_1")
    for key in ("plug_drawing", "socket_drawing", "gripper_drawing"):
        del content["record"]["made_with"][key]
    folder.store("plug_correction_1", content)
    moved_pin(folder)
    assert (await folder.facts()).correction is not None


def foreign_gripper(folder: Folder) -> None:
    folder.replace("connectors/gripper.toml", 'name = "gripper"', 'name = "gripper 2"')


def moved_pin(folder: Folder) -> None:
    """The name stays: somebody has corrected the drawing."""
    folder.replace(
        "connectors/micro-d-15-pins.toml", "position_mm = [-4.445,", "position_mm = [-4.435,"
    )


def moved_hole(folder: Folder) -> None:
    folder.replace("connectors/micro-d-15-holes.toml", "seat_depth_mm = 2.5", "seat_depth_mm = 2.4")


def moved_mark(folder: Folder) -> None:
    folder.replace("connectors/gripper.toml", "position_mm = [-24.0,", "position_mm = [-24.1,")


def moved_dot(folder: Folder) -> None:
    drawing = "connectors/reference-plate-above.toml"
    folder.replace(drawing, "diameter_mm = 1.2", "diameter_mm = 1.3")


def foreign_connector(folder: Folder) -> None:
    folder.replace("connectors/micro-d-15-pins.toml", 'name = "', 'name = "other-')


def exchanged_drawings(folder: Folder) -> None:
    folder.replace("antenna.toml", 'plug = "connectors/micro-d-15-pins', 'plug = "connectors/holes')
    holes = folder.path / "connectors" / "micro-d-15-holes.toml"
    (folder.path / "connectors" / "holes.toml").write_bytes(holes.read_bytes())


def exchanged_intrinsics(folder: Folder) -> None:
    content = folder.record("camera_2")
    record = content["record"]
    camera = single_camera_from_json(record)
    newer = replace(camera, image_size=(camera.image_size[0], camera.image_size[1] + 1))
    record |= {"id": newer.id, "image_size": list(newer.image_size)}
    folder.store("camera_2", content)


def changed_intrinsics(folder: Folder) -> None:
    content = folder.record("camera_2")
    content["record"]["camera_matrix"][0][2] += 1.0
    folder.store("camera_2", content)


def new_mounting(folder: Folder) -> None:
    content = folder.record("flange_T_cam1")
    folder.store("flange_T_cam1", content | {"made": "2026-11-23T12:00:00+00:00"})


def foreign_correction(folder: Folder) -> None:
    content = folder.record("plug_correction_1")
    content["record"]["made_with"]["scheme"] = "golden"
    folder.store("plug_correction_1", content)


def no_correction(folder: Folder) -> None:
    (folder.path / "antenna-calibration" / "plug_correction_1.json").unlink()


def exchanged_camera(folder: Folder) -> None:
    folder.serial_numbers["camera_2"] = "FC-0099"


MISTAKES: dict[str, tuple[Callable[[Folder], None], type[CellError], str]] = {
    "gripper": (foreign_gripper, CalibrationsDoNotBelongTogether, "gripper gripper, now gripper 2"),
    "connector": (foreign_connector, CalibrationsDoNotBelongTogether, "now other-micro-d-15 in"),
    "pin": (moved_pin, CalibrationsDoNotBelongTogether, "correction taught with plug_drawing"),
    "hole": (moved_hole, CalibrationsDoNotBelongTogether, "correction taught with socket_drawing"),
    "mark": (moved_mark, CalibrationsDoNotBelongTogether, "correction taught with gripper_drawing"),
    "dot": (moved_dot, CalibrationsDoNotBelongTogether, "reference taught with plate_above_draw"),
    "drawings": (exchanged_drawings, ConfigInvalid, "plug: .* has holes, not pins"),
    "intrinsics": (exchanged_intrinsics, CalibrationsDoNotBelongTogether, "base_T_cam2 was made"),
    "changed": (changed_intrinsics, CalibrationRecordInvalid, "camera_2: .*was changed"),
    "mounting": (new_mounting, CalibrationsDoNotBelongTogether, "cam1 531ca20152a6.*, now"),
    "correction": (foreign_correction, CalibrationsDoNotBelongTogether, "scheme golden, now"),
    "none": (no_correction, CalibrationMissing, "needs taught plugs"),
    "camera": (exchanged_camera, CalibrationRecordInvalid, "FC-0099"),
}


@pytest.mark.parametrize(("spoil", "fault", "words"), MISTAKES.values(), ids=MISTAKES.keys())
async def test_a_mistake_is_refused_by_name_before_anything_moves(
    folder: Folder, spoil: Callable[[Folder], None], fault: type[CellError], words: str
) -> None:
    spoil(folder)
    with pytest.raises(fault, match=words):
        await folder.facts()
