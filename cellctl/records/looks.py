"""What a look at a part leaves beside its images: when each was taken, and the rims found in it."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime

from cellctl.records.entries import Document, RunRecord

TAKEN, RIMS = "images.taken", "images.rims"
"""Keys of the documents: by file; by look and view."""


@dataclass(frozen=True, slots=True)
class TakenImage:
    """One raw image of a run."""

    look: str
    """Name of the measurement that it was taken for."""
    view: str
    """Name of the camera, of a stereo head with its side: ``head-1-left``."""
    time: datetime
    """When it had been received, UTC."""


@dataclass(frozen=True, slots=True)
class MeasuredRim:
    """A rim as it was measured in the images of one view.

    Pixels of the raw image with the centre of the first pixel at (0, 0), columns first.
    """

    name: str
    centre_px: tuple[float, float]
    """Onto which the centre of the circle projects; not the centre of the ellipse."""
    sigma_px: tuple[float, float] | None
    """Standard deviations of it; None where nothing was found."""
    ellipse_centre_px: tuple[float, float]
    semi_axes_px: tuple[float, float]
    """Major, minor."""
    angle_rad: float
    """Angle of the major axis, from the columns towards the rows."""
    residual_um: float | None = None
    """How far the feature lies from where the registered drawing has it; None where unknown."""
    used: bool = True
    """False for an outlier, or for one that was not found."""


def documents_of_look(
    look: str, taken: Mapping[str, TakenImage], rims: Mapping[str, Sequence[MeasuredRim]]
) -> tuple[Document, ...]:
    """``taken`` by the names of the files, ``rims`` by views."""
    images = {
        name: {"look": one.look, "view": one.view, "time": one.time.isoformat()}
        for name, one in taken.items()
    }
    found = {view: [asdict(rim) for rim in some] for view, some in rims.items()}
    return (Document(TAKEN, images), Document(RIMS, {look: found}))


def taken_images(record: RunRecord) -> dict[str, TakenImage]:
    """What is known of each image, by the name of its file; empty in runs that did not keep it."""
    return {
        name: TakenImage(one["look"], one["view"], datetime.fromisoformat(one["time"]))
        for name, one in record.document(TAKEN).items()
    }


def rims_of(record: RunRecord) -> dict[tuple[str, str], tuple[MeasuredRim, ...]]:
    """The rims that were measured, by look and view; empty in runs that did not keep them."""
    return {
        (look, view): tuple(_rim(one) for one in rims)
        for look, views in record.document(RIMS).items()
        for view, rims in views.items()
    }


def _rim(values: Mapping[str, object]) -> MeasuredRim:
    pairs = {
        name: tuple(value) if isinstance(value, list | tuple) else value
        for name, value in values.items()
    }
    return MeasuredRim(**pairs)  # type: ignore[arg-type]
