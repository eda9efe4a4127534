"""The record of a run, kept in the test."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.uncertain import UncertainPose


@dataclass
class Notes:
    """What was recorded, by its name."""

    figures: dict[str, float] = field(default_factory=dict)
    documents: dict[str, Any] = field(default_factory=dict)
    artefacts: list[str] = field(default_factory=list)
    phases: list[str] = field(default_factory=list)
    poses: dict[str, RigidTransform] = field(default_factory=dict)
    disk: Exception | None = None
    """What writing a file raises."""

    async def phase(self, number: int, label: str) -> None:
        self.phases.append(f"{number} {label}")

    async def figure(self, key: str, value: float, unit: str, **_limit: object) -> None:
        self.figures[key] = value

    async def figures_of(self, entries: Any) -> None:
        for one in entries:
            self.figures[one.key] = one.value

    async def document(self, key: str, content: Mapping[str, Any]) -> None:
        self.documents[key] = content

    async def measurement(
        self, key: str, _parent: str, _child: str, pose: UncertainPose, **_more: object
    ) -> None:
        self.poses[key] = pose.pose

    async def pose(
        self, key: str, origin: object, _parent: str, _child: str, pose: RigidTransform
    ) -> None:
        self.poses[f"{key} {origin}"] = pose

    async def artefact(self, name: str, _data: bytes, _kind: str) -> str:
        if self.disk is not None:
            raise self.disk
        self.artefacts.append(name)
        return name
