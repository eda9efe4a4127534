"""One open camera, by harvesters. Runs in the process of the maker's library only."""

import math
from typing import Any

from genicam import gentl
from harvesters.core import Callback, ImageAcquirer

from cellctl.clock import now_s
from drivers.camera.gige.library_process.chunks import image_chunks
from drivers.camera.gige.library_process.delivered import delivered, format_name, said, time_stamp
from drivers.camera.gige.library_process.features import Features
from drivers.camera.gige.library_process.image_memory import ImageMemory
from drivers.camera.gige.library_process.loss_event import LossEvent
from drivers.camera.gige.library_process.producers import Found
from drivers.camera.gige.library_process.selection import label_of, opened
from drivers.camera.gige.library_process.trouble import (
    GENICAM_ERRORS,
    TroubleError,
    camera_errors,
    in_words,
)
from drivers.camera.gige.protocol import CameraSetup, OpenedCamera, SentImage, Trouble

BUFFERS = 4
"""Images that a camera may have under way. One is asked for at a time; the others are for images
that come late, or that a free-running camera sends unasked."""
POLL_MS = 1
"""How long one look for an image waits inside the library, which holds the interpreter
meanwhile."""
_EMPTY_S = 0.003
"""How long one looks for images that were left over: longer than a poll of the event."""
_ASK_S = 0.5
"""Without an image for so long, the camera is asked whether it is there."""
_LOOK_S = 0.05
"""How often one looks for an event that says that it is not."""
FREE_RUNNING_SKIP = 2
"""Images of a free-running camera that are passed over after a request. The first may have been
exposed before the request and read out after it; the exposure of the second may have begun while
the first was read out. The third one begins after the second has ended."""


class GenicamCamera:
    """Open until its producers are closed; it acquires from ``start`` to ``stop``."""

    def __init__(self, found: Found, setup: CameraSetup) -> None:
        """Raises ``TroubleError``."""
        self.label = label_of(setup.keys)
        self._settings = setup.settings
        self._acquirer = opened(found, self.label)
        self._features = Features(self._acquirer.remote_device.node_map, self.label)
        self._acquirer.num_buffers = max(BUFFERS, self._acquirer.min_num_buffers)
        self._acquirer.timeout_period_on_update_event_data_call = POLL_MS
        self._incomplete = _Count()
        self._acquirer.add_callback(ImageAcquirer.Events.INCOMPLETE_BUFFER, self._incomplete)
        self._loss = LossEvent(self._acquirer.device.module)
        self._last_stamp = 0
        self._last_number = 0
        self._trigger_s = math.nan
        stated = [self._features.text(name) for name in ("DeviceSerialNumber", "DeviceID")]
        seen = found.seen
        self.serial_number = next(filter(None, (*stated, seen.serial_number, seen.id)), self.label)

    def set_up(self) -> None:
        """Write the settings; raises ``TroubleError`` with what the camera allows."""
        self._features.set_up(self._settings)

    def set_exposure(self, exposure_s: float) -> None:
        """Expose for so long from now on, or as near as the camera can; raises ``TroubleError``."""
        self._features.set_exposure(exposure_s)

    def stated(self) -> OpenedCamera:
        """What the camera says of itself once it is set up."""
        exposure_us = self._features.fixed("ExposureTime", "ExposureAuto")
        return OpenedCamera(
            serial_number=self.serial_number,
            pixel_format=self._pixel_format(),
            exposure_s=None if exposure_us is None else exposure_us * 1e-6,
            gain_db=self._features.fixed("Gain", "GainAuto"),
        )

    def start(self) -> None:
        """Begin to acquire: with a trigger, nothing is exposed yet."""
        self._last_number = 0  # they begin anew
        with camera_errors(self.label):
            self._acquirer.start()

    def stop(self) -> None:
        """End the acquisition; images that were not fetched are dropped."""
        with camera_errors(self.label):
            self._acquirer.stop()

    def close(self) -> None:
        """Let go of what would be left when the producers are closed."""
        self._loss.close()

    def drop_old(self) -> None:
        """Give back whatever was exposed before this call."""
        while self._waiting():
            incomplete = self._incomplete.count
            old = self._fetch(_EMPTY_S)
            if old is not None:
                self._give_back(old)
            elif self._incomplete.count == incomplete:  # which harvesters gives back by itself
                return

    def trigger(self) -> None:
        """Expose now; a camera that runs freely is exposing anyway."""
        if self._settings.trigger == "software":
            self._features.execute("TriggerSoftware")
        if self._settings.trigger in {"software", "none"}:
            self._trigger_s = now_s()

    def image(self, memory: ImageMemory) -> SentImage:
        """The image of the last trigger, its bytes lent from ``memory``.

        Raises ``TroubleError``: ``DAMAGED`` for an image that is not whole, or an old one, and
        ``SILENT`` when none comes in time.
        """
        skip = FREE_RUNNING_SKIP if self._settings.trigger == "none" else 0
        asked_s = now_s()
        until_s = asked_s + self._settings.image_timeout_s
        incomplete = self._incomplete.count
        while (left_s := until_s - now_s()) > 0:
            buffer = self._fetch(min(left_s, _LOOK_S))
            if self._incomplete.count > incomplete:
                raise TroubleError(Trouble.DAMAGED, f"{self.label}: packets are missing")
            if buffer is None:
                if self._loss.told() or now_s() - asked_s >= _ASK_S:
                    self._require_alive()
                    asked_s = now_s()
                continue
            if skip:
                skip -= 1
                self._give_back(buffer)
                continue
            return self._taken(buffer, memory)
        raise TroubleError(
            Trouble.SILENT,
            f"{self.label}: no image within {self._settings.image_timeout_s:g} s",
        )

    def _require_alive(self) -> None:
        """Raise ``TroubleError`` for a camera that does not answer: no image will come from it."""
        port = self._acquirer.remote_device.port
        try:
            port.read(0, 4)  # a register that the standards of all transports have, and no cache
        except (gentl.IoException, gentl.TimeoutException) as error:
            raise TroubleError(Trouble.LOST, f"{self.label}: {in_words(error)}") from error
        except GENICAM_ERRORS:
            return  # it has answered, though not what was asked

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

    def _taken(self, buffer: Any, memory: ImageMemory) -> SentImage:
        whole_s = now_s()
        nodes, device = self._acquirer.remote_device.node_map, self._acquirer.device.module
        try:
            with camera_errors(self.label, Trouble.DAMAGED):
                stamp, time_ns = time_stamp(buffer, device, nodes)
                self._require_new(stamp, said(lambda: int(buffer.frame_id), 0))
                image = delivered(buffer, nodes)
                if image is None:
                    raise TroubleError(Trouble.DAMAGED, f"{self.label}: a buffer without an image")
                chunks = image_chunks(buffer, nodes)
                return SentImage(
                    block=memory.filled(image.data),
                    pixel_format=image.pixel_format,
                    width=image.width,
                    height=image.height,
                    size=len(image.data),
                    device_time_ns=time_ns,
                    trigger_s=self._trigger_s,
                    time_s=whole_s,
                    exposure_s=chunks.exposure_s,
                    gain_db=chunks.gain_db,
                )
        except ValueError as error:
            raise TroubleError(Trouble.DAMAGED, f"{self.label}: {error}") from error
        finally:
            self._give_back(buffer)

    def _require_new(self, stamp: int, number: int) -> None:
        """Raise ``TroubleError`` for an old image that comes again; 0 for what is not known.

        The number of a frame counts where there is no clock. Neither is compared by size: a clock
        that is set by the network may go back, and numbers begin anew after the last of 16 bit.
        """
        before, self._last_stamp = self._last_stamp, stamp
        number_before, self._last_number = self._last_number, number
        if stamp == before if stamp else number and number == number_before:
            raise TroubleError(Trouble.DAMAGED, f"{self.label}: the image before came again")

    def _pixel_format(self) -> str:
        nodes = self._acquirer.remote_device.node_map
        return format_name(said(lambda: int(nodes.PixelFormat.get_int_value()), 0))

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
