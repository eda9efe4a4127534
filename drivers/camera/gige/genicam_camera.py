"""One open camera, by harvesters. Runs in the process of the maker's library only."""

import math
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from genicam import gentl
from harvesters.core import Callback, Harvester, ImageAcquirer
from numpy.typing import NDArray

from cellctl.clock import now_s
from drivers.camera.gige.config import Acquisition, Selection
from drivers.camera.gige.delivered import delivered, time_stamp
from drivers.camera.gige.features import Features
from drivers.camera.gige.protocol import OpenedCamera, SeenCamera, SentImage, Trouble
from drivers.camera.gige.trouble import GENICAM_ERRORS, TroubleError, camera_errors

BUFFERS = 4
POLL_MS = 1
_EMPTY_S = 0.003
"""How long one looks for images that were left over: longer than a poll of the event."""
FREE_RUNNING_SKIP = 2
"""Images of a free-running camera that are passed over after a request. The first may have been
exposed before the request and read out after it; the exposure of the second may have begun while
the first was read out. The third one begins after the second has ended."""


def seen_cameras(harvester: Harvester) -> tuple[SeenCamera, ...]:
    """All cameras that the producers see now. Closes those that are open."""
    with camera_errors("looking for cameras", Trouble.PRODUCER):
        harvester.update()
        return tuple(_seen(info) for info in harvester.device_info_list)


class GenicamCamera:
    """Open, set up and acquiring from the first call of ``start`` to ``close``."""

    def __init__(
        self,
        harvester: Harvester,
        seen: Sequence[SeenCamera],
        camera: Selection,
        settings: Acquisition,
    ) -> None:
        """``seen`` are the cameras that there are. Raises ``TroubleError``."""
        asked = camera.asked()
        self.label = " ".join(f"{key} {text}" for key, text in asked.items())
        self._settings = settings
        self._acquirer = _create(harvester, seen, asked, self.label)
        self._features = Features(self._acquirer.remote_device.node_map, self.label)
        self._acquirer.num_buffers = max(BUFFERS, self._acquirer.min_num_buffers)
        self._acquirer.timeout_period_on_update_event_data_call = POLL_MS
        self._incomplete = _Count()
        self._acquirer.add_callback(ImageAcquirer.Events.INCOMPLETE_BUFFER, self._incomplete)
        self._last_stamp = 0
        self._trigger_s = math.nan
        serial = self._features.text("DeviceSerialNumber") or self._features.text("DeviceID")
        self.serial_number = serial or self.label

    def set_up(self) -> None:
        """Write the settings; raises ``TroubleError`` with what the camera allows."""
        self._features.set_up(self._settings)

    def stated(self) -> OpenedCamera:
        """What the camera says of itself once it is set up."""
        exposure_us = self._features.fixed("ExposureTime", "ExposureAuto")
        return OpenedCamera(
            serial_number=self.serial_number,
            exposure_s=None if exposure_us is None else exposure_us * 1e-6,
            gain_db=self._features.fixed("Gain", "GainAuto"),
        )

    def start(self) -> None:
        """Begin to acquire: with a trigger, nothing is exposed yet."""
        with camera_errors(self.label):
            self._acquirer.start()

    def stop(self) -> None:
        """End the acquisition; images that were not fetched are dropped."""
        with camera_errors(self.label):
            self._acquirer.stop()

    def drop_old(self) -> None:
        """Give back whatever was exposed before this call."""
        while self._waiting() and (old := self._fetch(_EMPTY_S)) is not None:
            self._give_back(old)

    def trigger(self) -> None:
        """Expose now; nothing to do for a camera that runs freely."""
        if self._settings.trigger == "software":
            self._features.execute("TriggerSoftware")
            self._trigger_s = now_s()

    def image(self) -> tuple[SentImage, int] | None:
        """The image of the last trigger, and a descriptor of memory with its bytes.

        None for an image that is damaged or old.

        Raises ``TroubleError`` when none comes in time.
        """
        skip = FREE_RUNNING_SKIP if self._settings.trigger == "none" else 0
        until_s = now_s() + self._settings.image_timeout_s
        incomplete = self._incomplete.count
        while (left_s := until_s - now_s()) > 0:
            buffer = self._fetch(left_s)
            if self._incomplete.count > incomplete:
                return None
            if buffer is None:
                continue
            if skip:
                skip -= 1
                self._give_back(buffer)
                continue
            return self._taken(buffer)
        raise TroubleError(
            Trouble.SILENT,
            f"{self.label}: no image within {self._settings.image_timeout_s:g} s",
        )

    def close(self) -> None:
        """Let the camera go, whatever state it is in."""
        with camera_errors(self.label):
            self._acquirer.destroy()

    def _waiting(self) -> bool:
        """Whether images wait to be fetched; True where the producer does not say it."""
        try:
            return bool(self._acquirer.data_streams[0].num_awaiting_delivery)
        except (*GENICAM_ERRORS, AttributeError):
            return True

    def _fetch(self, timeout_s: float) -> Any:
        with camera_errors(self.label):
            try:
                return self._acquirer.try_fetch(timeout=timeout_s, is_raw=True)
            except gentl.TimeoutException:
                return None

    def _taken(self, buffer: Any) -> tuple[SentImage, int] | None:
        whole_s = now_s()
        nodes, device = self._acquirer.remote_device.node_map, self._acquirer.device.module
        try:
            with camera_errors(self.label, Trouble.DAMAGED):
                stamp, time_ns = time_stamp(buffer, device, nodes)
                # A time stamp that stands still is an old image again. Cameras without a clock say
                # 0, and clocks that are set by the network may go back.
                if stamp and stamp == self._last_stamp:
                    return None
                self._last_stamp = stamp
                image = delivered(buffer, nodes)
                if image is None:
                    return None
                meta = SentImage(
                    pixel_format=image.pixel_format,
                    width=image.width,
                    height=image.height,
                    size=len(image.data),
                    device_time_ns=time_ns,
                    trigger_s=self._trigger_s,
                    time_s=whole_s,
                )
                return meta, _memory(image.data)
        except ValueError as error:
            raise TroubleError(Trouble.DAMAGED, f"{self.label}: {error}") from error
        finally:
            self._give_back(buffer)

    def _give_back(self, buffer: Any) -> None:
        with camera_errors(self.label):
            buffer.parent.queue_buffer(buffer)


class _Count(Callback):  # type: ignore[misc]  # harvesters has no types
    """Counts its calls."""

    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def emit(self, context: object = None) -> None:  # noqa: ARG002 - given by harvesters
        self.count += 1


def _create(
    harvester: Harvester, cameras: Sequence[SeenCamera], asked: dict[str, str], label: str
) -> ImageAcquirer:
    key, text = next(iter(asked.items()))
    found = [n for n, seen in enumerate(cameras) if getattr(seen, key) == text]
    if not found:
        there = ", ".join(f"{one.serial_number} ({one.model})" for one in cameras) or "no camera"
        raise TroubleError(Trouble.ABSENT, f"no camera with {label}; there is {there}")
    if cameras[found[0]].busy:
        raise TroubleError(Trouble.BUSY, f"{label} is controlled by another program")
    with camera_errors(label):
        return harvester.create(found[0])


def _seen(info: Any) -> SeenCamera:
    def said(name: str) -> str:
        # Only a few of these are mandatory, and a producer says so by an exception.
        try:
            return str(getattr(info, name))
        except GENICAM_ERRORS:
            return ""

    busy = said("access_status") in ("3", "4", "5")
    return SeenCamera(
        producer=str(info.parent.parent.id_) if hasattr(info.parent, "parent") else "",
        id=said("id_"),
        vendor=said("vendor"),
        model=said("model"),
        serial_number=said("serial_number"),
        user_name=said("user_defined_name"),
        busy=busy,
    )


def _memory(data: NDArray[np.uint8]) -> int:
    """A descriptor of anonymous memory with a copy of ``data``."""
    block = os.memfd_create("gige-image", os.MFD_CLOEXEC)
    # The only copy on the way from the buffer of the producer to the daemon. Written and not
    # mapped: each page that is touched for the first time would cost a fault, twice the time.
    left = data.data
    while left:
        left = left[os.write(block, left) :]
    return block
