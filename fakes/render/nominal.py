"""A head, parts and poses like those of the cell, for tests and benchmarks without a world."""

from typing import Final, Literal

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.world.scene import (
    HoleKind,
    LensTruth,
    SceneChessboard,
    SceneDisc,
    SceneHole,
    ScenePlate,
    SceneTargetBoard,
    StereoTruth,
)

IMAGE_SIZE_PX: Final = (2448, 2048)
_PLACES_M: Final = {
    "P1": (-0.48, -0.18),
    "P2": (-0.48, -0.08),
    "P3": (-0.40, -0.23),
    "P4": (0.40, 0.23),
    "P5": (0.48, 0.18),
    "P6": (0.48, 0.08),
}
_PINS: Final = ("P1", "P5")
_THICKNESS_M: Final = {"deck": 15e-3, "frame": 40e-3}


def nominal_head(*, blur_px: float = 1.0) -> StereoTruth:
    """Two cameras like table 1 of the paper: f ≈ 3580 px, baseline 179 mm, toe-in 20°."""
    left = LensTruth(
        (3580.2, 3579.6), (1224.3, 995.4), (-0.07, 0.17, 4e-4, -3e-4, 0.0), blur_px, 1.0
    )
    right = LensTruth(
        (3582.9, 3582.1), (1221.8, 998.1), (-0.072, 0.18, -3e-4, 4e-4, 0.0), blur_px, 0.97
    )
    toe_in = Rotation.from_euler("y", 20, degrees=True)
    middle = np.array([0.179 * np.cos(np.radians(10)), 0.0, 0.179 * np.sin(np.radians(10))])
    left_T_right = RigidTransform.from_components(middle, toe_in.inv())
    return StereoTruth(IMAGE_SIZE_PX, left, right, left_T_right.inv())


def nominal_holes(kind: Literal["frame", "deck"]) -> tuple[SceneHole, ...]:
    """Six holes at their nominal places."""
    other: HoleKind = "thread" if kind == "frame" else "countersink"
    depth_m = 15e-3 if kind == "deck" else 25e-3
    return tuple(
        SceneHole(
            name=name,
            kind="pin" if name in _PINS else other,
            position_m=place,
            diameter_m=6e-3 if name in _PINS else 5e-3,
            countersink_m=10e-3 if kind == "deck" and name not in _PINS else None,
            depth_m=depth_m,
            through=kind == "deck" or name in _PINS,
        )
        for name, place in _PLACES_M.items()
    )


def nominal_plate(
    kind: Literal["frame", "deck"],
    *,
    head: Literal[1, 2] = 1,
    tilt_deg: tuple[float, float, float] = (0.0, 0.0, 0.0),
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    seed: int = 1,
) -> ScenePlate:
    """A part with its hole triangle in the middle of both images, 500 mm away.

    ``tilt_deg`` turns it about its own x, y, z; ``shift_m`` moves it along the axes of the head.
    """
    holes = nominal_holes(kind)
    triangle = holes[:3] if head == 1 else holes[3:]
    # A head sees only its own triangle of a part that is a metre long.
    centroid = np.mean([hole.position_m for hole in triangle], axis=0)
    centroid_T_part = RigidTransform.from_translation([-centroid[0], -centroid[1], 0.0])
    pose = facing_pose(shift_m=shift_m, tilt_deg=tilt_deg) * centroid_T_part
    return ScenePlate(kind, pose, (1.0, 0.5), _THICKNESS_M[kind], holes, seed)


def facing_pose(
    *,
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    tilt_deg: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> RigidTransform:
    """An object's frame in front of the head, z towards the middle between both cameras."""
    # Half of the toe-in: the plate then faces the middle between both cameras, as on a real stand.
    half_way = Rotation.from_euler("y", -10, degrees=True)
    towards = half_way * Rotation.from_euler("x", 180, degrees=True)
    rotation = towards * Rotation.from_euler("xyz", tilt_deg, degrees=True)
    return RigidTransform.from_components(np.array([0.0, 0.0, 0.508]) + shift_m, rotation)


def nominal_target_board(*, seed: int = 1) -> SceneTargetBoard:
    """Nine discs, 3 × 3, pitch 100 × 80 mm, named row by row."""
    discs = tuple(
        SceneDisc(f"P{3 * row + column + 1}", (0.1 * (column - 1), 0.08 * (row - 1)))
        for row in range(3)
        for column in range(3)
    )
    return SceneTargetBoard(facing_pose(), (0.4, 0.3), 0.02, discs, seed)


def nominal_chessboard(
    pose: RigidTransform | None = None, *, bow_m: tuple[float, float] = (0.0, 0.0)
) -> SceneChessboard:
    """11 × 8 inner corners, 20 mm pitch."""
    return SceneChessboard(
        facing_pose() if pose is None else pose, (11, 8), 0.02, (0.28, 0.22), bow_m, 1
    )
