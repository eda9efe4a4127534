"""Any value at any place of a file of the commands is read, or refused with its place."""

import json
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.calibration.input_file import read_input
from cellctl.calibration.solvers.hand_eye.hand_eye_input import HandEyeFile
from cellctl.errors import CellError
from cellctl.processes.antenna_module.commands.trial_file import (
    TeachFile,
    TrialFile,
    looks_of,
    read_cell_file,
)
from cellctl.processes.antenna_module.commands.turn_file import TurnFile
from cellctl.processes.antenna_module.faults.connector import PlaneFileInvalid
from cellctl.processes.antenna_module.vision.plane import read_plane
from tests.rigs.antenna.plugging_files import teach_content
from tests.rigs.sweeps import examples

TEACH = teach_content()
TRIAL = {
    **{key: TEACH[key] for key in TEACH if key != "plugs"},
    "looks": TEACH["plugs"][0]["looks"],
}
TURN = {"turns": [{"a6_deg": 10.0, "position_mm": [1.0, 2.0]}]}
POSE = [400.0, 0.0, 500.0, 0.0, 0.0, 180.0]
POSES = {
    "setup": "eye-in-hand",
    "camera_id": "a" * 64,
    "robot_sigma_mm": 0.05,
    "poses": [
        {
            "name": "one",
            "joints_deg": [10.0, -70.0, 110.0, 0.0, 50.0, 0.0],
            "base_T_flange": POSE,
            "camera_T_board": [0.0, 0.0, 250.0, 0.0, 0.0, 0.0],
            "covariance_mm_deg": [
                [1e-4 * (row == column) for column in range(6)] for row in range(6)
            ],
        }
    ],
}
PLANE = {
    "camera_id": "0" * 64,
    "camera_T_plane": [0.0, 0.0, 250.0, 0.0, 0.0, 0.0],
    "sigma_height_mm": 0.1,
    "expected": {"camera_T_connector": [0.0, 0.0, 250.0, 0.0, 0.0, 0.0], "within_mm": 1.0},
}


def read_trial(path: Path) -> None:
    trial = read_cell_file(path, TrialFile)
    looks_of(trial.looks)
    trial.cell()
    trial.now_s()


def read_teach(path: Path) -> None:
    teach = read_cell_file(path, TeachFile)
    teach.by_slot()
    teach.cell()


def read_turn(path: Path) -> None:
    [entry.stop() for entry in read_input(path, TurnFile).turns]


def read_poses(path: Path) -> None:
    file = read_input(path, HandEyeFile)
    file.stops()
    file.robot_noise()


FILES: dict[str, tuple[Any, Callable[[Path], object]]] = {
    "trial": (TRIAL, read_trial),
    "teach": (TEACH, read_teach),
    "turn": (TURN, read_turn),
    "poses": (POSES, read_poses),
    "plane": (PLANE, read_plane),
}


def places(content: Any, above: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Places of every value in a file; a long list gives those of its beginning."""
    inside = content.items() if isinstance(content, dict) else enumerate(content[:2])
    for key, value in inside:
        yield (*above, key)
        if isinstance(value, dict | list):
            yield from places(value, (*above, key))


LEAVES = (
    st.none()
    | st.booleans()
    | st.integers(-10, 10)
    | st.sampled_from([10**20, 10**400, -1e308, 1e308])
    | st.floats(allow_nan=True)
    | st.text(max_size=3)
)
VALUES = LEAVES | st.lists(LEAVES, max_size=6) | st.dictionaries(st.text(max_size=2), LEAVES)


@pytest.mark.parametrize("name", FILES)
def test_the_file_is_good_before_anything_is_changed(name: str, tmp_path: Path) -> None:
    content, read = FILES[name]
    path = tmp_path / f"{name}.json"
    path.write_text(json.dumps(content))
    read(path)


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=examples(60), deadline=None)
@given(data=st.data())
def test_any_value_at_any_place_is_read_or_refused(
    name: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    content, read = FILES[name]
    place = data.draw(st.sampled_from(list(places(content))))
    spoiled = deepcopy(content)
    holder = spoiled
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = data.draw(VALUES)
    path = tmp_path_factory.getbasetemp() / f"fuzzed-{name}.json"
    path.write_text(json.dumps(spoiled))
    # A ``ValueError`` of the looks becomes ``FileInvalid`` in the command.
    with suppress(CellError, ValueError):
        read(path)


@given(content=st.binary(max_size=60))
def test_any_bytes_are_refused(content: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "noise.json"
    path.write_bytes(content)
    with pytest.raises(PlaneFileInvalid, match="noise"):
        read_plane(path)
