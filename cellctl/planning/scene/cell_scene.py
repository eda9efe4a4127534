"""The cell as its model has it: arms, their bodies, and what stands around them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cellctl.cell.zones.zone import zones_of
from cellctl.config.cell import CellConfig
from cellctl.geometry.box import Box
from cellctl.geometry.pose import Array
from cellctl.planning.scene.arm import PlannedArm
from cellctl.planning.scene.head_limits import HeadLimits
from cellctl.planning.scene.solid import Solid
from cellctl.planning.scene.surroundings import Clearances, StandingSolid, Surroundings


@dataclass(frozen=True, slots=True)
class Standpoint:
    """Where another arm stands while one moves."""

    label: str
    """Name in findings, for example ``measuring``."""
    joints_rad: tuple[float, ...]
    reach_m: float = 0.0
    """How far any of its bodies may be from there; it is kept free too."""


@dataclass(frozen=True, slots=True, eq=False)
class CellScene:
    """Everything of a model in SI units."""

    cell: CellConfig
    folder: Path
    """That of the cell file, which names its drawings from there."""
    arms: Mapping[str, PlannedArm]
    solids: tuple[Solid, ...]
    approaches: Clearances
    """What stays free, in m, between two bodies in an approach."""
    heads: Mapping[str, HeadLimits]
    """Limits of the stereo heads that the model describes."""

    def during(self, procedures: frozenset[int]) -> "CellScene":
        """The same without the bodies that are away in all of these procedures; itself for none.

        A move that also another procedure makes, or a run, has to be free beside all bodies.
        """
        if not procedures:
            return self
        solids = tuple(solid for solid in self.solids if not procedures <= solid.absent_in)
        return replace(self, solids=solids)

    def with_arms(self, arms: Mapping[str, PlannedArm]) -> "CellScene":
        """The same with these arms, and with what they are configured to in its cell."""
        robots = {**self.cell.robots, **{name: arm.config for name, arm in arms.items()}}
        return replace(self, cell=self.cell.model_copy(update={"robots": robots}), arms=arms)

    def around(
        self,
        robot: str,
        others: Mapping[str, Sequence[Standpoint]],
        *,
        approach: bool = False,
    ) -> Surroundings:
        """One arm with all fixtures, and with each other arm at all of its standpoints at once.

        An arm without a standpoint is left out, so whoever leaves one out must have a reason.
        ``approach``: bodies that belong together may come as near as the model says.
        """
        standing = [
            StandingSolid(solid, solid.link_T_shape, solid.name)
            for solid in self.solids
            if solid.arm is None
        ]
        # Of these frames only the base's is used below, which no joint moves: any joints will do.
        own = self.arms[robot].link_frames(np.zeros(6))
        for solid in self._of(robot):
            if solid.still:
                standing.append(StandingSolid(solid, own[0] @ solid.link_T_shape, solid.name))
        for other, standpoints in others.items():
            standing += self._at(other, standpoints)
        moving = [solid for solid in self._of(robot) if not solid.still]
        near = self.approaches if approach else {}
        return Surroundings(self.arms[robot], moving, standing, near, self._closed(robot, others))

    def _closed(self, robot: str, others: Mapping[str, Sequence[Standpoint]]) -> dict[str, Box]:
        """The zones that the arbiter would not grant: another arm is in them where it stands."""
        return {
            zone.name: zone.shares[robot].box
            for zone in zones_of(self.cell)
            if robot in zone.shares
            and any(
                zone.shares[other].box.holds(
                    self.arms[other].base_T_flange(np.array(standpoint.joints_rad)).translation
                )
                for other, standpoints in others.items()
                if other in zone.shares
                for standpoint in standpoints
            )
        }

    def placed(self, joints_rad: Mapping[str, Array]) -> list[tuple[Solid, Array]]:
        """Each body with its ``cell_T_shape``, shape (4, 4), at joints of shape (6,) by robot."""
        frames = {name: self.arms[name].link_frames(at) for name, at in joints_rad.items()}
        return [
            (solid, solid.link_T_shape)
            if solid.arm is None
            else (solid, frames[solid.arm][solid.link] @ solid.link_T_shape)
            for solid in self.solids
            if solid.arm is None or solid.arm in frames
        ]

    def _of(self, robot: str) -> list[Solid]:
        return [solid for solid in self.solids if solid.arm == robot]

    def _at(self, robot: str, standpoints: Sequence[Standpoint]) -> list[StandingSolid]:
        found = []
        for number, standpoint in enumerate(standpoints):
            frames = self.arms[robot].link_frames(np.array(standpoint.joints_rad))
            for solid in self._of(robot):
                # What never moves is the same at all of them.
                if solid.still and number:
                    continue
                pose = frames[solid.link] @ solid.link_T_shape
                wider = replace(solid, margin_m=solid.margin_m + standpoint.reach_m)
                found.append(StandingSolid(wider, pose, f"{solid.name} at {standpoint.label}"))
        return found
