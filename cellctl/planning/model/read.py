"""Reads the model of a cell, and says everything that is wrong with it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.cell import CellConfig
from cellctl.errors.config import (
    ArmNotDescribed,
    ConfigInvalid,
    HeadNotDescribed,
    SizeImplausible,
)
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.planning.model.document import (
    BodyKeys,
    CapsuleKeys,
    HeadKeys,
    LinkBodyKeys,
    ModelDocument,
)
from cellctl.planning.model.read_document import read_document
from cellctl.planning.model.shapes import BoxShape, CapsuleShape, Shape
from cellctl.planning.model.surface import read_surface
from cellctl.planning.scene.arm import PlannedArm, planned_arm
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.head_limits import HeadLimits, ImageQuality
from cellctl.planning.scene.solid import Solid

_FARTHEST_M = 5.0
"""No body of an arm lies farther from the frame of its link."""
_SMALLEST_M = 5e-3
"""Nothing that an arm may hit is smaller than this in its greatest dimension."""
_THINNEST_MM = 1.0
_SLENDER = 100.0
"""A capsule that is thinner and so many times as long as its radius is a link in metres:
of real ones the radius is half a metre at most, and neither hoses nor needles are so thin."""
_FLATTEST_MM = 0.5
"""No sheet or pane is thinner; a body of half a metre, written in metres, is."""
_FASTEST_RAD_S = 2.0 * math.pi
"""No joint of an arm turns faster, and the fastest one of none needs a minute for a turn."""
_BASES_APART_M = 0.05
"""No two arms stand nearer to each other, base to base."""


def read_model(cell: CellConfig, path: Path, folder: Path) -> CellScene:
    """The model of a cell file that was checked, and that lies in ``folder``.

    Raises ``ConfigUnreadable``, ``ConfigInvalid``, ``ArmNotDescribed``, ``MeshNotUsable``,
    ``SizeImplausible``.
    """
    document = read_document(path)
    arms = {name: _arm(cell, document, name) for name in document.robots}
    _check_bases(arms)
    solids = tuple(_solids(document, path.parent))
    _check_movers(arms, solids)
    _check_approaches(document, solids, path)
    approaches = {frozenset(near.bodies): near.clearance_mm * MM for near in document.approaches}
    heads = {name: _head(cell, name, keys) for name, keys in document.stereo_cameras.items()}
    return CellScene(cell, folder, arms, solids, approaches, heads)


def _arm(cell: CellConfig, document: ModelDocument, name: str) -> PlannedArm:
    if name not in cell.robots:
        known = ", ".join(cell.robots) or "none"
        raise ArmNotDescribed(f"robots.{name}: not a robot of the cell file, which has {known}")
    keys = document.robots[name]
    if max(keys.rated_deg_s) <= _FASTEST_RAD_S:
        raise SizeImplausible(
            f"robots.{name}.rated_deg_s = {list(keys.rated_deg_s)}: degrees per second belong "
            "here; these look like radians"
        )
    return planned_arm(
        name,
        cell.robots[name],
        pose_from_xyzabc(keys.cell_T_base),
        np.radians(keys.rated_deg_s),
        math.radians(keys.joint_margin_deg),
    )


def _head(cell: CellConfig, name: str, keys: HeadKeys) -> HeadLimits:
    if name not in cell.stereo_cameras:
        known = ", ".join(cell.stereo_cameras) or "none"
        raise HeadNotDescribed(
            f"stereo_cameras.{name}: not one of the cell file, which has {known}"
        )
    nearest_mm, farthest_mm = keys.sharp_mm
    return HeadLimits(
        nearest_m=nearest_mm * MM,
        farthest_m=farthest_mm * MM,
        margin_px=keys.margin_px,
        greatest_angle_rad=math.radians(keys.greatest_angle_deg),
        lit_within_rad=math.radians(keys.lit_within_deg),
        quality=ImageQuality(keys.contrast_grey, keys.noise_grey, keys.blur_px),
    )


def _check_bases(arms: Mapping[str, PlannedArm]) -> None:
    for one, other in combinations(arms.values(), 2):
        apart_m = float(np.linalg.norm(one.cell_T_base.translation - other.cell_T_base.translation))
        if apart_m < _BASES_APART_M:
            raise SizeImplausible(
                f"cell_T_base of {one.name} and {other.name}: {apart_m / MM:.1f} mm apart, "
                f"expected at least {_BASES_APART_M / MM:g} mm; lengths are in mm"
            )


def _solids(document: ModelDocument, folder: Path) -> Iterator[Solid]:
    for name, fixture in document.fixtures.items():
        yield _solid(name, fixture, None, 0.0, folder)
    for robot, arm in document.robots.items():
        for name, body in arm.bodies.items():
            yield _solid(f"{robot}.{name}", body, robot, arm.margin_mm * MM, folder)


def _solid(name: str, keys: BodyKeys, arm: str | None, margin_m: float, folder: Path) -> Solid:
    shape, pose = _shape(keys, folder)
    link = keys.link if isinstance(keys, LinkBodyKeys) else 0
    solid = Solid(name, arm, link, pose, shape, margin_m, keys.stand_in, keys.absent_in)
    # A body in metres would shrink to a grain, and every move past it would be free.
    if 2 * shape.radius_m < _SMALLEST_M:
        raise SizeImplausible(
            f"{name}: {2000 * shape.radius_m:.2g} mm at its greatest, "
            f"expected at least {_SMALLEST_M / MM:g} mm; lengths are in mm"
        )
    _check_thickness(name, keys)
    # Fixtures may be anywhere in the hall; a part of an arm that lies metres from its link was
    # written in another unit.
    reach_m = float(np.linalg.norm(pose[:3, 3])) + shape.radius_m
    if arm is not None and reach_m > _FARTHEST_M:
        raise SizeImplausible(
            f"{name}: reaches {reach_m:.1f} m from the frame of its link, "
            f"expected at most {_FARTHEST_M:g} m"
        )
    return solid


def _check_thickness(name: str, keys: BodyKeys) -> None:
    """One figure in metres among others in mm, as a radius beside a length."""
    if keys.capsule is not None:
        radius_mm = keys.capsule.radius_mm
        length_mm = math.dist(keys.capsule.from_mm, keys.capsule.to_mm)
        if radius_mm < _THINNEST_MM and length_mm > _SLENDER * radius_mm:
            raise SizeImplausible(
                f"{name}: radius_mm = {radius_mm:g} with a length of {length_mm:g} mm, expected at "
                f"least {_THINNEST_MM:g} mm; lengths are in mm"
            )
    if keys.box is not None and min(keys.box.size_mm) < _FLATTEST_MM:
        raise SizeImplausible(
            f"{name}: {min(keys.box.size_mm):g} mm in size_mm, expected at least "
            f"{_FLATTEST_MM:g} mm; lengths are in mm"
        )


def _shape(keys: BodyKeys, folder: Path) -> tuple[Shape, Array]:
    """The shape and its frame in that of the body, shape (4, 4)."""
    if keys.capsule is not None:
        return _capsule(keys.capsule)
    if keys.box is not None:
        x, y, z = keys.box.size_mm
        return BoxShape((x * MM, y * MM, z * MM)), pose_from_xyzabc(keys.box.at).as_matrix()
    assert keys.mesh is not None, "the model of the keys asks for one of the three"
    return read_surface(keys.mesh, folder), pose_from_xyzabc(keys.mesh.at).as_matrix()


def _capsule(keys: CapsuleKeys) -> tuple[Shape, Array]:
    start_m, end_m = np.array(keys.from_mm) * MM, np.array(keys.to_mm) * MM
    way_m = end_m - start_m
    length_m = float(np.linalg.norm(way_m))
    turn = Rotation.identity()
    # A capsule without length is a ball, which has no direction to be turned to.
    if length_m > 0.0:
        turn = Rotation.align_vectors([way_m], [[0.0, 0.0, 1.0]])[0]
    pose = RigidTransform.from_components((start_m + end_m) / 2, turn)
    return CapsuleShape(keys.radius_mm * MM, length_m), pose.as_matrix()


def _check_movers(arms: Mapping[str, PlannedArm], solids: Sequence[Solid]) -> None:
    """An arm of which nothing moves would find every one of its ways free."""
    for name in arms:
        if all(solid.still for solid in solids if solid.arm == name):
            raise ArmNotDescribed(f"robots.{name}: all of its bodies stand on its base (link 0)")


def _check_approaches(document: ModelDocument, solids: Sequence[Solid], path: Path) -> None:
    known = {solid.name for solid in solids}
    for near in document.approaches:
        for name in near.bodies:
            if name not in known:
                raise ConfigInvalid(
                    f"{path}: approaches: no body {name!r}, there are {', '.join(sorted(known))}"
                )
