"""How an image came about, for the record beside it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ExposureRecord:
    """What a driver knows of one exposure; None where its camera does not say."""

    serial_number: str | None
    pixel_format: str
    """As the camera sent it, which may be deeper than what the driver hands on."""
    bits: int
    """Significant bits of a sample as the driver hands it on."""
    exposure_s: float | None = None
    gain_db: float | None = None
    averaged: int = 1
    """Exposures of which the image is the mean; time stamps are those of the last."""
    taken_again: int = 0
    """Exposures that were dropped for this image, because they came damaged or were old ones."""
    device_time_ns: int | None = None
    """By the camera's own clock; its zero is the camera's affair."""
