"""Holes of a part as points in C1, from one or two heads."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.linalg import block_diag

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose, skew
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.rigid_fit import kabsch


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPoints:
    """n holes: where they are on the drawing, where they were seen, how certain that is."""

    names: tuple[str, ...]
    nominal_m: Array
    """Places on the drawing, in the axes of the part, shape (n, 3)."""
    measured_m: Array
    """Places as seen, in C1, shape (n, 3)."""
    covariances_m2: Array
    """Covariances of the measured points in C1, shape (n, 3, 3)."""
    by_transfer: Array
    """Derivative of each point by the error of ``c1_T_c2``, shape (n, 3, 6)."""
    frames: int = 1
    """Pictures of each head over which the points are averaged."""

    @classmethod
    def seen(
        cls,
        head_1: PairMeasurement,
        head_2: PairMeasurement | None,
        c1_T_c2: UncertainPose | None,
        holes: Sequence[Hole],
    ) -> Self:
        """All measured points in C1, in the order of ``holes``."""
        rows: dict[str, tuple[Array, Array, Array]] = {
            hole.name: (hole.position_m, hole.covariance_m2, np.zeros((3, 6)))
            for hole in head_1.holes
        }
        if head_2 is not None:
            if c1_T_c2 is None:
                raise ValueError("points of a second head need c1_T_c2")
            rotation = c1_T_c2.pose.rotation.as_matrix()
            for hole in head_2.holes:
                turned = rotation @ hole.position_m
                rows[hole.name] = (
                    turned + c1_T_c2.pose.translation,
                    rotation @ hole.covariance_m2 @ rotation.T,
                    np.hstack([np.eye(3), -skew(turned)]),
                )
        used = [hole for hole in holes if hole.name in rows]
        return cls(
            tuple(hole.name for hole in used),
            np.array([hole.position_m for hole in used]).reshape(-1, 3),
            np.array([rows[hole.name][0] for hole in used]).reshape(-1, 3),
            np.array([rows[hole.name][1] for hole in used]).reshape(-1, 3, 3),
            np.array([rows[hole.name][2] for hole in used]).reshape(-1, 3, 6),
            head_1.frames,
        )

    def off_their_drawing(self, holes: Sequence[Hole]) -> Self:
        """These points with the manufacturing tolerance of their holes in the covariances.

        A hole that lies off its drawing moves along x and y of the part, not along z: its rim stays
        in the face. There must be at least three points that are not on a line.
        """
        sigmas_m = {hole.name: hole.position_sigma_m for hole in holes}
        rotation, _ = kabsch(self.nominal_m, self.measured_m)
        across = rotation[:, :2]  # x and y of the part in C1
        squares = np.array([sigmas_m[name] ** 2 for name in self.names])
        spread = squares[:, None, None] * (across @ across.T)
        return replace(self, covariances_m2=self.covariances_m2 + spread)

    def as_seen(self, seen: "MeasuredPoints") -> Self:
        """These points with the covariances that they have in ``seen``, which holds them all."""
        rows = [seen.names.index(name) for name in self.names]
        return replace(self, covariances_m2=seen.covariances_m2[rows])

    def joint_covariance(self, transfer_covariance: Array) -> Array:
        """Covariance of all coordinates with the errors shared by ``c1_T_c2``, (3n, 3n)."""
        shared = self.by_transfer.reshape(-1, 6)
        return np.asarray(
            block_diag(*self.covariances_m2) + shared @ transfer_covariance @ shared.T
        )

    def without(self, index: int) -> "MeasuredPoints":
        """The points without the one of this index."""
        keep = [i for i in range(len(self.names)) if i != index]
        return replace(
            self,
            names=tuple(self.names[i] for i in keep),
            nominal_m=self.nominal_m[keep],
            measured_m=self.measured_m[keep],
            covariances_m2=self.covariances_m2[keep],
            by_transfer=self.by_transfer[keep],
        )
