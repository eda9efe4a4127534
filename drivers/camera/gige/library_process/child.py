"""The process in which the maker's library lives: answers one request after the other."""

import ctypes
import os
import signal
from contextlib import suppress
from multiprocessing import reduction
from multiprocessing.connection import Connection
from pathlib import Path

from drivers.camera.gige.library_process.genicam_camera import GenicamCamera
from drivers.camera.gige.library_process.image_memory import ImageMemory
from drivers.camera.gige.library_process.producers import Found, Producers
from drivers.camera.gige.library_process.selection import selected
from drivers.camera.gige.library_process.trouble import TroubleError
from drivers.camera.gige.producer_files import PRODUCER_PATH, producer_files
from drivers.camera.gige.protocol import (
    Answer,
    CamerasSeen,
    Grabbed,
    GrabRequest,
    ListRequest,
    Opened,
    OpenRequest,
    Request,
    RequestFailed,
    SentImage,
    SetExposureRequest,
    Trouble,
)

_PR_SET_PDEATHSIG = 1


def serve(connection: Connection, parent: int) -> None:
    """Entry of the process; ends with the other end of the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the daemon ends its children in its own order
    # A producer that hangs would not notice that its daemon is gone, and keep the cameras.
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        return
    cameras = _Cameras()
    try:
        with suppress(EOFError, OSError):
            while True:
                answer, blocks = cameras.answer(connection.recv())
                connection.send(answer)
                for block in blocks:
                    reduction.send_handle(connection, block, parent)
    finally:
        # Also after what nobody has foreseen: a camera that is not let go answers nobody else
        # until its own patience ends.
        cameras.close()


class _Cameras:
    """The producers and the cameras that are open."""

    def __init__(self) -> None:
        self._producers: Producers | None = None
        self._open: list[GenicamCamera] = []
        self._memory = ImageMemory()
        self._tries = 1
        self._clean = False
        self._fired_by_others = False

    def answer(self, request: Request) -> tuple[Answer, list[int]]:
        """Carry a request out; the answer and descriptors of the images' memory."""
        try:
            match request:
                case ListRequest(producers):
                    return self._seen(producers), []
                case OpenRequest():
                    return self._opened(request), []
                case GrabRequest(released):
                    self._memory.take_back(released)
                    grabbed = self._grabbed()
                    return grabbed, [image.block for image in grabbed.images]
                case SetExposureRequest(exposure_s):
                    for camera in self._open:
                        camera.set_exposure(exposure_s)
                    return self._stated(), []
        except TroubleError as error:
            self._clean = False
            return RequestFailed(error.trouble, str(error)), []

    def close(self) -> None:
        """Let everything go; a camera that is gone does not hinder the others."""
        for camera in self._open:
            camera.close()
        self._open = []
        if self._producers is not None:
            self._producers.close()
            self._producers = None

    def _look(self, producers: tuple[Path, ...]) -> tuple[Found, ...]:
        if self._producers is None:
            files = producer_files(producers)
            if not files:
                text = f"no producer: neither the settings nor {PRODUCER_PATH} name one (.cti)"
                raise TroubleError(Trouble.PRODUCER, text)
            self._producers = Producers(files)
        return self._producers.look()

    def _seen(self, producers: tuple[Path, ...]) -> CamerasSeen:
        found = self._look(producers)
        return CamerasSeen(tuple(one.seen for one in found), self._unusable)

    @property
    def _unusable(self) -> tuple[str, ...]:
        return () if self._producers is None else self._producers.unusable

    def _opened(self, request: OpenRequest) -> Opened:
        first = request.cameras[0].settings
        there = self._look(first.producers)
        # All are found before one is opened: a mistyped name costs nothing then.
        found = [selected(there, one.keys, self._unusable) for one in request.cameras]
        for one, setup in zip(found, request.cameras, strict=True):
            camera = GenicamCamera(one, setup)
            self._open.append(camera)
            camera.set_up()
        for camera in self._open:
            camera.start()
        self._clean = True
        self._tries = first.tries
        self._fired_by_others = first.trigger.startswith("Line")
        return self._stated()

    def _stated(self) -> Opened:
        return Opened(tuple(camera.stated() for camera in self._open))

    def _grabbed(self) -> Grabbed:
        damage = ""
        for tried in range(self._tries):
            try:
                images = self._expose()
            except TroubleError as error:
                if error.trouble is not Trouble.DAMAGED:
                    raise
                damage = str(error)
                continue
            return Grabbed(tuple(images), tried)
        text = f"{self._tries} exposures, none of them whole and new; of the last: {damage}"
        raise TroubleError(Trouble.DAMAGED, text)

    def _expose(self) -> list[SentImage]:
        """One image of every camera; raises ``TroubleError``."""
        if not self._clean or self._fired_by_others:
            # Whatever is still on its way belongs to a request that has failed, or to a pulse from
            # before this one: a wire does not ask whether anybody waits.
            for camera in self._open:
                camera.stop()
                camera.start()
            self._clean = True
        for camera in self._open:
            camera.drop_old()
        # Nothing between the triggers of a head: both cameras are to expose together.
        for camera in self._open:
            camera.trigger()
        return self._images()

    def _images(self) -> list[SentImage]:
        images: list[SentImage] = []
        damaged: list[TroubleError] = []
        try:
            for camera in self._open:
                try:
                    images.append(camera.image(self._memory))
                except TroubleError as error:
                    if error.trouble is not Trouble.DAMAGED:
                        raise
                    damaged.append(error)  # the others are fetched all the same: nobody else does
            if damaged:
                raise damaged[0]
        except TroubleError:
            self._memory.take_back(image.block for image in images)
            raise
        return images
