"""How an image came about, for the record beside it, and how that is changed."""

from dataclasses import dataclass

from cellctl.errors.camera import ExposureNotAdjustable


@dataclass(frozen=True, slots=True)
class ExposureRecord:
    """What a driver knows of one exposure; None where its camera does not say."""

    serial_number: str | None
    pixel_format: str
    """Format in which the camera sent the image; it may be deeper than what the driver hands on."""
    bits: int
    """Significant bits of a sample as the driver hands it on."""
    exposure_s: float | None = None
    gain_db: float | None = None
    averaged: int = 1
    """Exposures of which the image is the mean; time stamps are those of the last."""
    taken_again: int = 0
    """Exposures that were dropped for this image, because they came damaged or were old ones."""
    device_time_ns: int | None = None
    """Time by the camera's own clock; where its zero lies is the camera's affair."""


class AdjustableExposure:
    """What camera and head offer where their driver can do it."""

    name: str

    async def set_exposure(self, exposure_s: float) -> float:  # noqa: ARG002 - for those who can
        """Expose the next images for so long, until the device is disconnected.

        Returns the time that the camera has made of it, the nearest that it can. Raises
        ``ExposureNotAdjustable`` where the driver has no way to do it, else the faults of ``grab``.
        """
        raise ExposureNotAdjustable(f"{self.name}: {type(self).__name__}")
