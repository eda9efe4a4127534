"""What other equipment or other holes would make of a planned measurement."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.config.stated.views import StatedMeasurement, StatedPart
from cellctl.geometry.pose import Array
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.views.looks import left_T_middle, middle_T_left
from cellctl.planning.views.prediction import PredictedPose, ViewGeometry, predicted_pose
from cellctl.planning.views.seeing import SeenHoles, why_unseen
from cellctl.vision.camera.stereo_head import StereoHead
from cellctl.vision.features.hole import Hole

BASELINE_RATIO = 1.5
"""The longer baseline whose gain is stated."""
_WIDER = np.arange(1.1, 3.01, 0.1)
"""Ratios of the distances between the holes of a head, which are tried one after the other."""


@dataclass(frozen=True, slots=True, eq=False)
class Gain:
    """One change, and the pose that counts with it."""

    change: str
    predicted: PredictedPose


def gains(scene: CellScene, placement: ViewGeometry) -> Iterator[Gain]:
    """What is gained with both heads where they are planned."""
    statement = placement.measurement
    most = replace(placement, frames=statement.max_frames)
    yield Gain(
        f"{statement.max_frames} pictures instead of {placement.frames}", predicted_pose(most)
    )
    twice = replace(placement, image_variance=0.5)
    yield Gain("a second head beside each, at the same holes", predicted_pose(twice))
    yield Gain(f"a baseline {BASELINE_RATIO:g} times as long", predicted_pose(_longer(placement)))
    if (wider := _widest(scene, placement)) is not None:
        yield wider
    yield from _further(scene, placement)


def _longer(placement: ViewGeometry) -> ViewGeometry:
    """The middle of each head stays, and both lines of sight meet where they met."""
    heads, cameras = [], []
    for stated, cell_T_left in zip(
        placement.measurement.heads, placement.cell_T_cameras, strict=True
    ):
        head, middle_T_left = with_baseline(stated.camera, BASELINE_RATIO)
        heads.append(replace(stated, camera=head))
        cameras.append(cell_T_left * left_T_middle(stated.camera) * middle_T_left)
    statement = replace(placement.measurement, heads=(heads[0], heads[1]))
    return replace(placement, measurement=statement, cell_T_cameras=(cameras[0], cameras[1]))


def with_baseline(head: StereoHead, ratio: float) -> tuple[StereoHead, RigidTransform]:
    """A head with another baseline, and ``middle_T_left`` of it; its covariance is not known."""
    toe_in = 2.0 * np.arctan(ratio * np.tan(_toe_in_rad(head) / 2.0))
    more = Rotation.from_euler("y", (toe_in - _toe_in_rad(head)) / 2.0)
    places = []
    # The left camera is on the side of negative x and turns towards positive x, the right one back.
    for camera, turn in ((RigidTransform.identity(), more), (head.right_T_left.inv(), more.inv())):
        in_middle = middle_T_left(head) * camera
        places.append(
            RigidTransform.from_components(
                in_middle.translation * [ratio, 1.0, 1.0], turn * in_middle.rotation
            )
        )
    right_T_left = places[1].inv() * places[0]
    moved = replace(
        head,
        rotation=right_T_left.rotation.as_matrix(),
        translation_m=right_T_left.translation,
        covariance=None,
    )
    return moved, places[0]


def _toe_in_rad(head: StereoHead) -> float:
    forward = head.right_T_left.inv().rotation.apply([0.0, 0.0, 1.0])
    return float(np.arccos(np.clip(forward[2], -1.0, 1.0)))


def _widest(scene: CellScene, placement: ViewGeometry) -> Gain | None:
    """Holes of the same kinds, as far apart as the pictures hold."""
    found: Gain | None = None
    for ratio in _WIDER:
        spread = _with_holes(placement.measurement, float(ratio))
        other = replace(placement, measurement=spread)
        if not _all_seen(scene, other):
            break
        text = f"holes of a head {ratio:.1f} times as far apart, as far as the picture holds them"
        found = Gain(text, predicted_pose(other))
    return found


def _with_holes(statement: StatedMeasurement, ratio: float) -> StatedMeasurement:
    def spread(holes: tuple[Hole, ...]) -> tuple[Hole, ...]:
        middle: Array = np.mean([hole.position_m for hole in holes], axis=0)
        # Along the face: how deep a rim lies is a matter of its kind.
        scale = np.array([ratio, ratio, 1.0])
        return tuple(
            replace(hole, position_m=middle + scale * (hole.position_m - middle)) for hole in holes
        )

    parts = tuple(
        replace(part, seen={name: spread(holes) for name, holes in part.seen.items()})
        for part in statement.parts
    )
    return replace(statement, parts=parts)


def _further(scene: CellScene, placement: ViewGeometry) -> Iterator[Gain]:
    """Each hole of the drawing that no head measures so far, where a head sees it in all parts."""
    statement = placement.measurement
    for name in dict.fromkeys(hole.name for hole in statement.parts[0].further):
        for stated in statement.heads:
            parts = tuple(_with_further(part, stated.name, name) for part in statement.parts)
            other = replace(placement, measurement=replace(statement, parts=parts))
            if not _all_seen(scene, other):
                continue
            yield Gain(f"hole {name} too, by {stated.name}", predicted_pose(other))


def _with_further(part: StatedPart, head: str, name: str) -> StatedPart:
    more = tuple(hole for hole in part.further if hole.name == name)
    return replace(part, seen={**part.seen, head: part.seen[head] + more})


def _all_seen(scene: CellScene, placement: ViewGeometry) -> bool:
    statement = placement.measurement
    return all(
        why_unseen(
            stated.camera,
            scene.heads[stated.name],
            camera,
            SeenHoles(cell_T_part, part.seen[stated.name]),
        )
        is None
        for stated, camera in zip(statement.heads, placement.cell_T_cameras, strict=True)
        for part, cell_T_part in zip(statement.parts, placement.cell_T_parts, strict=True)
    )
