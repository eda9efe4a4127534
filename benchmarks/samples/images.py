"""Images: a chessboard before a small stereo head, a plate with holes, a connector."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import MM
from fakes.render import api
from fakes.world.scene import LensTruth, SceneChessboard, SceneHole, ScenePlate, StereoTruth
from tests.rigs.antenna import small_pictures as pictures

PAIRS, SQUARE_MM, CORNERS = 8, 20.0, (9, 6)
_SHRINK = 4
"""The images have every fourth pixel of the cell's heads: small files."""
_QUIET = api.RenderOptions.clean(noise_grey=0.4)
_HOLES_MM = {"A": (-45.0, -30.0), "B": (45.0, -30.0), "C": (45.0, 38.0), "D": (-45.0, 30.0)}
_DIAMETER_MM = 16.0


def head() -> StereoTruth:
    """The nominal head of the cell, with fewer pixels."""
    full = api.nominal_head()
    left, right = (
        LensTruth(
            (lens.focal_px[0] / _SHRINK, lens.focal_px[1] / _SHRINK),
            (lens.centre_px[0] / _SHRINK, lens.centre_px[1] / _SHRINK),
            lens.distortion,
            lens.blur_px,
            lens.gain,
        )
        for lens in (full.left, full.right)
    )
    return StereoTruth((612, 512), left, right, full.right_T_left)


def write_board(folder: Path) -> None:
    """Pairs of a chessboard, tilted to all sides."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(4)
    size_m = ((CORNERS[0] + 2) * SQUARE_MM * MM, (CORNERS[1] + 2) * SQUARE_MM * MM)
    for number in range(1, PAIRS + 1):
        pose = api.facing_pose(
            shift_m=(*rng.uniform(-0.05, 0.05, 2), rng.uniform(-0.03, 0.06)),
            tilt_deg=(*rng.uniform(-25, 25, 2), rng.uniform(-180, 180)),
        )
        board = SceneChessboard(pose, CORNERS, SQUARE_MM * MM, size_m, (5e-5, 3e-5), 1)
        pair = api.render_pair(head(), [board], _QUIET, rng)
        for side, image in zip(("left", "right"), pair, strict=True):
            _save(folder / f"{side}-{number:02d}.png", image)


def write_plate(folder: Path) -> None:
    """One pair of a plate with four holes, and its drawing."""
    folder.mkdir(parents=True, exist_ok=True)
    holes = tuple(
        SceneHole(name, "pin", (x * MM, y * MM), _DIAMETER_MM * MM, None, 12e-3, through=True)
        for name, (x, y) in _HOLES_MM.items()
    )
    pose = api.facing_pose(shift_m=(2e-3, -1e-3, 0.0), tilt_deg=(2.0, -3.0, 1.0))
    plate = ScenePlate("plate", pose, (0.16, 0.12), 12e-3, holes, 1)
    pair = api.render_pair(head(), [plate], _QUIET, np.random.default_rng(2))
    for side, image in zip(("left", "right"), pair, strict=True):
        _save(folder / f"{side}.png", image)
    rows = [
        f'[[hole]]\nname = "{name}"\nkind = "pin"\ndiameter_mm = {_DIAMETER_MM}\n'
        f"position_mm = [{x}, {y}, 0.0]\n"
        for name, (x, y) in _HOLES_MM.items()
    ]
    (folder / "plate.toml").write_text("\n".join(rows), encoding="utf-8")


def write_connector(folder: Path) -> None:
    """One image of a plug with the calibration of its camera and the plane of its contacts."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(pictures.CONNECTOR, folder / pictures.CONNECTOR.name)
    pictures.picture().write(folder)
    for name in ("cam.json", "plane.json"):
        path = folder / name
        path.write_text(json.dumps(json.loads(path.read_text()), indent=1) + "\n")


def _save(path: Path, image: NDArray[np.uint8]) -> None:
    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    if not done:
        raise OSError(f"{path} could not be encoded as PNG")
    path.write_bytes(data.tobytes())
