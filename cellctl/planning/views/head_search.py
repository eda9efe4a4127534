"""One head: the places from which it sees its holes and at which its arm can stand."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.views import StatedHead, StatedMeasurement
from cellctl.errors.config import HeadNotDescribed
from cellctl.geometry.pose import Array
from cellctl.planning.scene.cell_scene import CellScene, Standpoint
from cellctl.planning.scene.head_limits import HeadLimits
from cellctl.planning.scene.surroundings import Surroundings
from cellctl.planning.views.looks import HeadLook, aim_at, left_T_middle, look_of, middle_T_left
from cellctl.planning.views.prediction import part_in_cell
from cellctl.planning.views.seeing import SeenHoles, why_unseen
from cellctl.planning.views.sight import Sights
from cellctl.planning.views.standing import (
    VIEWS_OUT_OF_REACH,
    reaches_views,
    standing_at,
)
from cellctl.planning.ways.polyline import joints_at


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """A head where it sees everything that it is to see."""

    look: HeadLook
    joints_rad: Array
    """Joints of its arm, shape (6,)."""
    cell_T_camera: RigidTransform
    """Its left camera."""


@dataclass(slots=True, eq=False)
class HeadSearch:
    """The conditions of one head, with the arms that carry no head at all of their places."""

    scene: CellScene
    head: StatedHead
    limits: HeadLimits
    parts: tuple[SeenHoles, ...]
    others: Mapping[str, tuple[Standpoint, ...]]
    """Places of the arms that carry no head."""
    sights: tuple[tuple[SeenHoles, Mapping[str, Array]], ...]
    """What the head looks at, and where those arms stand meanwhile."""
    aim: RigidTransform
    refused: Counter[str] = field(default_factory=Counter)
    """Why places were refused, and how often."""
    _around: Surroundings | None = None

    @classmethod
    def of(cls, scene: CellScene, measurement: StatedMeasurement, number: int) -> "HeadSearch":
        """For the first (0) or second (1) head of a measurement.

        Raises ``HeadNotDescribed``, and ``PlaceUnreachable`` for a place of another arm.
        """
        head = measurement.heads[number]
        if head.name not in scene.heads or head.robot not in scene.arms:
            raise HeadNotDescribed(f"the model has no stereo_cameras.{head.name} on {head.robot}")
        bases = {name: arm.cell_T_base for name, arm in scene.arms.items()}
        others: dict[str, tuple[Standpoint, ...]] = {}
        sights = []
        for part in measurement.parts:
            standing = {
                name: joints_at(scene.arms[name], place)
                for name, place in part.others.items()
                if name in scene.arms
            }
            for name, joints_rad in standing.items():
                point = Standpoint(part.others[name].label, tuple(joints_rad))
                others[name] = (*others.get(name, ()), point)
            seen = SeenHoles(part_in_cell(part, bases), part.seen[head.name])
            sights.append((seen, standing))
        parts = tuple(seen for seen, _ in sights)
        aim = aim_at(np.vstack([seen.places_m for seen in parts]), parts[0].cell_T_part)
        return cls(scene, head, scene.heads[head.name], parts, others, tuple(sights), aim)

    def taught(self) -> Viewpoint:
        """Where the cell file has the head now, whether it sees anything from there or not."""
        arm = self.scene.arms[self.head.robot]
        joints_rad = arm.taught_rad(self.head.pose)
        camera = arm.cell_T_base * arm.base_T_flange(joints_rad) * self.head.flange_T_camera
        look = look_of(camera * left_T_middle(self.head.camera), self.aim)
        return Viewpoint(look, joints_rad, camera)

    def camera_at(self, look: HeadLook) -> RigidTransform:
        """``cell_T_camera`` of the left camera."""
        return look.cell_T_middle(self.aim) * middle_T_left(self.head.camera)

    def seeing(self, looks: Iterable[HeadLook]) -> Iterator[HeadLook]:
        """Those from which all holes are well in both images; nothing else is looked at."""
        for look in looks:
            why = self._why_unseen(self.camera_at(look))
            if why is None:
                yield look
            else:
                self.refused[why] += 1

    def viewpoint(self, look: HeadLook) -> Viewpoint | None:
        """The head there, if everything allows it apart from the other head."""
        camera = self.camera_at(look)
        why = self._why_unseen(camera)
        if why is None:
            arm = self.scene.arms[self.head.robot]
            flange = camera * self.head.flange_T_camera.inv()
            near_rad = arm.taught_rad(self.head.pose)
            standing = standing_at(arm, self._surroundings(), flange, near_rad)
            why = standing.why_not
            if standing.joints_rad is not None:
                found = Viewpoint(look, standing.joints_rad, camera)
                why = self.hidden(found, {})
                if why is None and not reaches_views(
                    arm, found.joints_rad, self.head.flange_T_views
                ):
                    why = VIEWS_OUT_OF_REACH
                if why is None:
                    return found
        self.refused[why or ""] += 1
        return None

    def hidden(self, viewpoint: Viewpoint, also: Mapping[str, Array]) -> str | None:
        """What stands between the head and a hole; ``also`` are joints of further arms."""
        for seen, standing in self.sights:
            joints_rad = {**standing, **also, self.head.robot: viewpoint.joints_rad}
            sights = Sights(self.scene, joints_rad, self.head.robot)
            why = sights.hidden_by(self.head.camera, viewpoint.cell_T_camera, seen)
            if why is not None:
                return why
        return None

    def has_room_beside(self, viewpoint: Viewpoint, other: str, joints_rad: Array) -> bool:
        """Whether the arm has room with the arm of the other head at joints of shape (6,)."""
        beside = {other: (Standpoint("its viewpoint", tuple(joints_rad)),)}
        around = self.scene.around(self.head.robot, beside)
        return around.refusal(viewpoint.joints_rad) is None and around.has_room(
            viewpoint.joints_rad, 0.0
        )

    def _why_unseen(self, camera: RigidTransform) -> str | None:
        return next(
            (
                why
                for seen in self.parts
                if (why := why_unseen(self.head.camera, self.limits, camera, seen))
            ),
            None,
        )

    def _surroundings(self) -> Surroundings:
        if self._around is None:
            self._around = self.scene.around(self.head.robot, self.others)
        return self._around
