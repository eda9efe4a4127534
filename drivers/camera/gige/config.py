"""The settings of a GenTL camera and of a head of two. Seconds, dB, bytes."""

from dataclasses import fields
from ipaddress import IPv4Address
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from drivers.camera.gige.protocol import CameraSettings, CameraSetup, SensorRegion

Seconds = Annotated[float, Field(gt=0.0, le=600.0)]
Feature = bool | int | float | str
Line = r"Line\d{1,2}"


class Selection(BaseModel):
    """Which of the cameras that the producers see. Exactly one key is given."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    serial_number: str = ""
    user_name: str = ""
    """What the maker's tool calls "user defined name" or "device user ID"."""
    ip_address: str = ""
    """Of the camera. It stays the same only where it was set in the camera or by a DHCP server."""
    id: str = ""
    """As the producer names it."""

    @model_validator(mode="after")
    def _one_key(self) -> Self:
        if len(self.asked()) != 1:
            raise ValueError("name a camera by one of serial_number, user_name, ip_address and id")
        return self

    @field_validator("ip_address")
    @classmethod
    def _an_address(cls, text: str) -> str:
        return str(IPv4Address(text)) if text else text

    def asked(self) -> dict[str, str]:
        """The key that is given, with its value."""
        return {name: text for name, text in self.model_dump().items() if text}


class Region(BaseModel):
    """The part of the sensor that is read out, px."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    width: Annotated[int, Field(gt=0)]
    height: Annotated[int, Field(gt=0)]
    offset_x: Annotated[int, Field(ge=0)] = 0
    offset_y: Annotated[int, Field(ge=0)] = 0


class Acquisition(BaseModel):
    """How cameras are set up. What is left out stays as the camera has it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    producers: tuple[Path, ...] = ()
    """Files of GenTL producers (``.cti``); without any, those of GENICAM_GENTL64_PATH."""
    trigger: Annotated[str, Field(pattern=rf"^(software|none|{Line})$")] = "software"
    """``Line1`` and so on: the next pulse on this input. ``none`` for a camera that runs freely:
    the third image after the request is taken, of which the exposure surely begins after it."""
    burst: Annotated[int, Field(ge=1, le=64)] = 1
    """Exposures of which an image is the mean; nothing may move meanwhile."""
    pixel_format: str = ""
    exposure_s: Annotated[float, Field(gt=0.0, le=60.0)] | None = None
    gain_db: float | None = None
    packet_bytes: Annotated[int, Field(ge=220, le=16384)] | None = None
    packet_delay_ticks: Annotated[int, Field(ge=0)] | None = None
    region: Region | None = None
    features: dict[str, Feature] = Field(default_factory=dict)
    """Further features by their standard names (GenICam SFNC), written after those above."""
    connect_timeout_s: Seconds = 20.0
    """For loading the producers and opening the cameras."""
    image_timeout_s: Seconds = 5.0
    """From the trigger to the whole image, for each try."""
    tries: Annotated[int, Field(ge=1, le=20)] = 3
    """Exposures for one image: one that misses packets is taken again."""

    def setup_of(self, camera: Selection) -> CameraSetup:
        """This for one camera, in the words of the process of the maker's library."""
        said = {one.name: getattr(self, one.name) for one in fields(CameraSettings)}
        region = self.region and SensorRegion(**self.region.model_dump())
        return CameraSetup(camera.asked(), CameraSettings(**said | {"region": region}))


class GigeCameraConfig(Acquisition):
    """One camera."""

    camera: Selection
    grey: bool = False
    """Hand colour and mosaics on as 8 bit grey."""


class GigeHeadConfig(Acquisition):
    """Two cameras that are triggered together."""

    left: Selection
    right: Selection
    right_trigger: Annotated[str, Field(pattern=rf"^({Line})?$")] = ""
    """The input of the right camera that the exposure output of the left one is wired to; without
    one, the right camera is triggered as the left one is."""
    left_features: dict[str, Feature] = Field(default_factory=dict)
    """Features of the left camera alone, written after ``features``: its output, for example."""
    right_features: dict[str, Feature] = Field(default_factory=dict)
    max_difference_s: Seconds = 0.005
    """Between the exposures of both cameras: by the times of their triggers in this PC, and by what
    their own clocks say from one pair to the next. Of cameras that run freely (``trigger`` "none"):
    between the request and the last image, unless ``clocks_agree``."""
    clocks_agree: bool = False
    """The clocks of both cameras are set by each other (IEEE 1588): compared as they are."""

    def of_left(self) -> Acquisition:
        """How the left camera is set up."""
        return self.model_copy(update={"features": self.features | self.left_features})

    def of_right(self) -> Acquisition:
        """How the right camera is set up."""
        trigger = self.right_trigger or self.trigger
        features = self.features | self.right_features
        return self.model_copy(update={"trigger": trigger, "features": features})

    @model_validator(mode="after")
    def _two_cameras(self) -> Self:
        if self.left == self.right:
            raise ValueError("left and right are the same camera")
        if self.trigger == "none" and "max_difference_s" not in self.model_fields_set:
            raise ValueError(
                "cameras that run freely do not meet: say by max_difference_s for how long nothing "
                "moves; it takes about four frames of the camera"
            )
        if self.trigger == "none" and self.right_trigger:
            raise ValueError("a right_trigger needs a trigger of the left camera")
        return self
