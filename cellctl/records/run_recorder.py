"""The way in which any process records its run: figures, poses, passes, phases and files."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from scipy.spatial.transform import RigidTransform

from cellctl.calibration.pose_record import covariance_to_written
from cellctl.geometry.pose import Array, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import (
    Document,
    Figure,
    LoopPass,
    PoseOrigin,
    RecordedPose,
    RunDetail,
)
from cellctl.records.figures import NO_LIMIT, Limit, figure
from cellctl.records.files.raw_images import GreyImage
from cellctl.records.store import RunStore

EXPOSURES = "images.exposures"
"""Key of the document that says how the raw images of a run were exposed."""


@dataclass(frozen=True, slots=True)
class RunRecorder:
    """Writes the entries of one open run into the store.

    Every call returns when its record is on the disk. All of them raise ``RecordNotWritten``,
    ``RunUnknown`` or ``RunClosed``. What is recorded belongs to the phase that was begun last.
    """

    store: AsyncRunStore
    run: int
    """Number of the run."""

    async def phase(self, number: int, label: str) -> None:
        """Begin a phase; the one before ends. ``number`` is that of the step register."""
        await self.store.do(RunStore.begin_phase, self.run, number, label)

    async def measurement(
        self,
        key: str,
        parent: str,
        child: str,
        pose: UncertainPose,
        *,
        residual_um: float | None = None,
        frames: int | None = None,
        detail: Mapping[str, Any] | None = None,
    ) -> None:
        """A measured ``parent_T_child`` with its covariance (SI, see ``UncertainPose``).

        ``residual_um`` is the rms over the features that were fitted, ``frames`` the number of
        images that were averaged, ``detail`` plain data of the process.
        """
        await self.add(
            RecordedPose(
                key=key,
                origin=PoseOrigin.MEASURED,
                parent=parent,
                child=child,
                pose_mm_deg=_six(pose_to_xyzabc(pose.pose)),
                # Beside the covariance, although it follows from it: evaluation in SQL cannot take
                # the root of a diagonal.
                sigma_mm_deg=_six(in_mm_deg(pose.sigma)),
                covariance_mm_deg=tuple(
                    _six(row) for row in covariance_to_written(pose.covariance)
                ),
                residual_um=residual_um,
                frames=frames,
                detail=detail or {},
            )
        )

    async def pose(
        self, key: str, origin: PoseOrigin, parent: str, child: str, pose: RigidTransform
    ) -> None:
        """A ``parent_T_child`` that was commanded, or that a robot reported."""
        await self.add(RecordedPose(key, origin, parent, child, _six(pose_to_xyzabc(pose))))

    async def figure(
        self, key: str, value: float | None, unit: str, *, label: str = "", limit: Limit = NO_LIMIT
    ) -> Figure:
        """A named figure, with its verdict where it has a limit.

        ``key`` is stable over all runs, nested with dots (``approach.speed``); without a ``label``
        the key says it in words. A figure recorded again replaces the earlier one in the report;
        both are kept.
        """
        entry = figure(key, value, unit, label=label, limit=limit)
        await self.add(entry)
        return entry

    async def figures(self, entries: Iterable[Figure]) -> None:
        """Several figures in one transaction: each would cost a write to the disk of its own."""
        await self.add(*entries)

    async def loop_pass(self, entry: LoopPass) -> None:
        """One pass of a loop that measures and corrects."""
        await self.add(entry)

    async def document(self, key: str, content: Mapping[str, Any]) -> None:
        """Plain data of the process that is no figure; keys end in their unit."""
        await self.add(Document(key, content))

    async def add(self, *details: RunDetail) -> None:
        """Details of several kinds in one transaction; all of them are recorded, or none."""
        await self.store.do(RunStore.add, self.run, *details)

    async def exposures(self, taken: Mapping[str, ExposureRecord | None]) -> None:
        """How raw images were exposed, by the names of their files; None where nobody knows."""
        known = {name: asdict(one) for name, one in taken.items() if one is not None}
        if known:
            await self.document(EXPOSURES, known)

    def raw_image(self, name: str, image: GreyImage) -> None:
        """An image as the camera gave it, shape (height, width); kept later, see ``keep_image``."""
        self.store.keep_image(self.run, name, image)

    async def artefact(self, name: str, data: bytes, media_type: str) -> str:
        """A file of the run, by a name that no other file of the run has; its SHA-256."""
        return await self.store.do(RunStore.add_artefact, self.run, name, data, media_type)


def _six(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
