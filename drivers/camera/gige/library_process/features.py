"""Features of a camera by their standard names (GenICam SFNC), written with clear refusals."""

from difflib import get_close_matches
from typing import Any

from genicam import genapi, gentl

from drivers.camera.gige.library_process.trouble import (
    GENICAM_ERRORS,
    TroubleError,
    camera_errors,
    in_words,
)
from drivers.camera.gige.protocol import CameraSettings, SensorRegion, Trouble

_OTHER_EDITIONS = {
    "ExposureTime": "ExposureTimeAbs",  # before SFNC 1.5.1, in µs too
    "Gain": "GainAbs",  # before SFNC 1.5.1, in dB too; GainRaw has a unit of each maker's own
    "GevSCPSPacketSize": "DeviceStreamChannelPacketSize",  # from SFNC 2.0 on, of any transport
}
_SHOWN = 12
"""Names of features that a refusal lists: cameras have hundreds."""
_NOT_THERE = (genapi.EAccessMode.NI, genapi.EAccessMode.NA)
_READABLE = (genapi.EAccessMode.RO, genapi.EAccessMode.RW)


class Features:
    """The node map of one camera."""

    def __init__(self, nodes: Any, label: str) -> None:
        self._nodes = nodes
        self._label = label

    def has(self, name: str) -> bool:
        """Whether the camera has a feature of this name, and has it now.

        Makers describe a family of cameras by one text, in which a feature that this one lacks is
        "not implemented", and one that its other settings exclude "not available".
        """
        return self._access(name) not in _NOT_THERE

    def text(self, name: str) -> str:
        """A feature as text; empty where the camera does not have it, or does not say it."""
        if self._access(name) not in _READABLE:
            return ""
        with camera_errors(self._label):
            return str(getattr(self._nodes, name).value)

    def fixed(self, name: str, automatic: str) -> float | None:
        """A number that stays as it is; None where the camera lacks it or sets it by itself."""
        name = self._name_of(name)
        if self._access(name) not in _READABLE or self.text(automatic) not in ("", "Off"):
            return None
        with camera_errors(self._label):
            return float(getattr(self._nodes, name).value)

    def execute(self, name: str) -> None:
        """Carry out a command feature."""
        with camera_errors(self._label):
            getattr(self._nodes, name).execute()

    def write(self, name: str, value: object) -> None:
        """Set a feature; raises ``TroubleError`` with what the camera allows."""
        if not self.has(name):
            raise TroubleError(Trouble.FEATURE, f"{self._label} {self._lack_of(name)}")
        node = getattr(self._nodes, name)
        try:
            node.value = value
        except gentl.IoException as error:
            raise TroubleError(Trouble.LOST, f"{self._label}: {in_words(error)}") from error
        except (*GENICAM_ERRORS, TypeError, ValueError) as error:
            text = f"{self._label} refuses {name} = {value}{_allowed(node)}"
            raise TroubleError(Trouble.FEATURE, text) from error

    def set_up(self, settings: CameraSettings) -> None:
        """Write all settings; raises ``TroubleError``."""
        # First, so that the settings' own features meet the trigger that starts a frame.
        self._switch_other_triggers_off()
        if settings.pixel_format:
            self.write("PixelFormat", settings.pixel_format)
        if settings.region is not None:
            self._set_region(settings.region)
        if settings.exposure_s is not None:
            self._end_automatic_exposure()
            self.write(self._name_of("ExposureTime"), settings.exposure_s * 1e6)
        if settings.gain_db is not None:
            self._write_if_there("GainAuto", "Off")
            self.write(self._name_of("Gain"), settings.gain_db)
        if settings.packet_bytes is not None:
            self.write(self._name_of("GevSCPSPacketSize"), settings.packet_bytes)
        if settings.packet_delay_ticks is not None:
            self.write("GevSCPD", settings.packet_delay_ticks)
        for name, value in settings.features.items():
            self.write(name, value)
        self._set_trigger(settings)

    def set_exposure(self, exposure_s: float) -> None:
        """Fix the exposure, at the nearest that the camera can; raises ``TroubleError``."""
        self._end_automatic_exposure()
        name = self._name_of("ExposureTime")
        exposure_us = exposure_s * 1e6
        if self.has(name):
            node = getattr(self._nodes, name)
            with camera_errors(self._label):
                exposure_us = min(max(exposure_us, float(node.min)), float(node.max))
        self.write(name, exposure_us)

    def _end_automatic_exposure(self) -> None:
        # What sets itself is read-only, or is overwritten by the camera in the next image.
        self._write_if_there("ExposureMode", "Timed")
        self._write_if_there("ExposureAuto", "Off")

    def _set_region(self, region: SensorRegion) -> None:
        # Offsets first to zero: the new size may not fit beside the old ones.
        for name, value in (
            ("OffsetX", 0), ("OffsetY", 0), ("Width", region.width), ("Height", region.height),
            ("OffsetX", region.offset_x), ("OffsetY", region.offset_y),
        ):  # fmt: skip
            # Without offsets a camera reads out from its first pixel on, which is an offset of 0.
            if value or self.has(name):
                self.write(name, value)

    def _set_trigger(self, settings: CameraSettings) -> None:
        self._write_if_there("AcquisitionMode", "Continuous")
        # Again: the settings' own features may have selected another one.
        self._write_if_there("TriggerSelector", "FrameStart")
        if settings.trigger == "none":
            self._write_if_there("TriggerMode", "Off")
            return
        if settings.trigger == "software" and not self.has("TriggerSoftware"):
            text = f'{self._label} has no software trigger; set trigger = "none", or "Line1"'
            raise TroubleError(Trouble.FEATURE, text)
        self.write("TriggerMode", "On")
        wired = settings.trigger.startswith("Line")
        self.write("TriggerSource", settings.trigger if wired else "Software")

    def _switch_other_triggers_off(self) -> None:
        """Leave the start of a frame selected; another trigger that was left on waits for ever."""
        if not self.has("TriggerSelector"):
            return
        with camera_errors(self._label):
            selectors = list(self._nodes.TriggerSelector.symbolics)
        for selector in selectors:
            if selector != "FrameStart":
                self.write("TriggerSelector", selector)
                self._write_if_there("TriggerMode", "Off")
        self._write_if_there("TriggerSelector", "FrameStart")

    def _write_if_there(self, name: str, value: str) -> None:
        # What a camera cannot do otherwise is often there all the same, and read-only.
        if self.has(name) and self.text(name) != value:
            self.write(name, value)

    def _access(self, name: str) -> int:
        """How a feature may be used now, by the standard's ``EAccessMode``."""
        node = getattr(self._nodes, name, None)
        if node is None:
            return int(genapi.EAccessMode.NI)
        with camera_errors(self._label):
            return int(node.get_access_mode())

    def _lack_of(self, name: str) -> str:
        if self._access(name) == genapi.EAccessMode.NA:
            return f"has the feature {name}, but not with its other settings as they are"
        known = {n.lower(): n for n in sorted(dir(self._nodes)) if n[:1].isupper() and self.has(n)}
        asked = name.lower()
        alike = [low for low in known if low in asked or asked in low]
        alike += get_close_matches(asked, known, n=_SHOWN, cutoff=0.5)
        shown = [known[low] for low in dict.fromkeys(alike or known)][:_SHOWN]
        return f"has no feature {name}; it has {', '.join(shown)}"

    def _name_of(self, name: str) -> str:
        """The name that this camera has for a feature: that of another edition, if need be."""
        other = _OTHER_EDITIONS.get(name, name)
        return name if self.has(name) or not self.has(other) else other


def _allowed(node: Any) -> str:
    """What a feature takes, in words; empty where it does not say."""

    def said(name: str) -> Any:
        try:
            return getattr(node, name)
        except (*GENICAM_ERRORS, AttributeError):
            return None

    if (names := said("symbolics")) is not None:
        return f"; allowed: {', '.join(names)}"
    low, high, step = said("min"), said("max"), said("inc")
    if low is None or high is None:
        return ""
    return f"; allowed: {low} to {high}" + (f" in steps of {step}" if step else "")
