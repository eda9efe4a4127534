"""Shapes of bodies: for distances (FCL), for pictures (trimesh), and the ball around each."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import fcl
import numpy as np
import trimesh

from cellctl.geometry.pose import Array


class Shape(ABC):
    """A shape about the origin of its own frame; lengths in m."""

    @abstractmethod
    def geometry(self) -> Any:
        """The shape for the collision library."""

    @abstractmethod
    def mesh(self) -> trimesh.Trimesh:
        """The shape for pictures."""

    @property
    @abstractmethod
    def radius_m(self) -> float:
        """Radius of a ball about the origin that holds the shape.

        Comparing balls is so quick that only near pairs are measured by the collision library.
        """


@dataclass(frozen=True, slots=True)
class CapsuleShape(Shape):
    """Along z, with half its length on either side of the origin; the ends are half balls."""

    ball_m: float
    length_m: float
    """Distance between the middles of the ends."""

    def geometry(self) -> Any:
        """The body for FCL, whose length is that between the middles of the ends."""
        return fcl.Capsule(self.ball_m, self.length_m)

    def mesh(self) -> trimesh.Trimesh:
        """About the origin."""
        mesh = trimesh.creation.capsule(self.length_m, self.ball_m, count=[12, 12])
        # FCL has a capsule about its middle; the picture must not depend on where trimesh has it.
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
        return mesh

    @property
    def radius_m(self) -> float:
        """Radius about the middle that reaches to the tips."""
        return self.length_m / 2 + self.ball_m


@dataclass(frozen=True, slots=True)
class BoxShape(Shape):
    """Along the axes."""

    size_m: tuple[float, float, float]

    def geometry(self) -> Any:
        """The body for FCL, which takes full lengths of the sides."""
        return fcl.Box(*self.size_m)

    def mesh(self) -> trimesh.Trimesh:
        """Twelve triangles."""
        return trimesh.creation.box(self.size_m)

    @property
    def radius_m(self) -> float:
        """Radius about the middle that reaches to the corners."""
        return float(np.linalg.norm(self.size_m)) / 2


@dataclass(frozen=True, slots=True, eq=False)
class MeshShape(Shape):
    """A closed surface, which counts with its convex hull: FCL sees surfaces and not what is inside
    them, so that a body within a hollow one would pass for free."""

    surface: trimesh.Trimesh

    def geometry(self) -> Any:
        """The convex hull."""
        hull = self.surface.convex_hull
        # FCL takes the faces as one row of numbers, each face with the count of its corners before.
        triangles = np.column_stack([np.full(len(hull.faces), 3), hull.faces])
        return fcl.Convex(np.array(hull.vertices), len(hull.faces), triangles.ravel())

    def mesh(self) -> trimesh.Trimesh:
        """The surface itself."""
        return self.surface

    @property
    def radius_m(self) -> float:
        """Radius about the origin that reaches to the farthest corner."""
        corners: Array = np.asarray(self.surface.vertices, dtype=float)
        return float(np.linalg.norm(corners, axis=1).max())
