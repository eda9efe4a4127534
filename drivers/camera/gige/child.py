"""The process in which the maker's library lives: answers one request after the other."""

import ctypes
import os
import signal
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing import reduction
from multiprocessing.connection import Connection
from pathlib import Path

from harvesters.core import Harvester

from drivers.camera.gige.config import Acquisition
from drivers.camera.gige.genicam_camera import GenicamCamera, seen_cameras
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
    Trouble,
)
from drivers.camera.gige.trouble import TroubleError

PRODUCER_PATH = "GENICAM_GENTL64_PATH"
_PR_SET_PDEATHSIG = 1


def serve(connection: Connection, parent: int) -> None:
    """Entry of the process; ends with the other end of the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the daemon ends its children in its own order
    # A producer that hangs would not notice that its daemon is gone, and keep the cameras.
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        return
    cameras = _Cameras()
    with suppress(EOFError, OSError):
        while True:
            answer, blocks = cameras.answer(connection.recv())
            connection.send(answer)
            for block in blocks:
                reduction.send_handle(connection, block, parent)
                os.close(block)
    cameras.close()


class _Cameras:
    """The producers and the cameras that are open."""

    def __init__(self) -> None:
        self._harvester: Harvester | None = None
        self._open: list[GenicamCamera] = []
        self._damaged = 0
        self._tries = 1
        self._clean = False
        self._fired_by_others = False

    def answer(self, request: Request) -> tuple[Answer, list[int]]:
        """Carry a request out; the answer and descriptors of the images' memory."""
        try:
            match request:
                case ListRequest(acquisition):
                    return CamerasSeen(seen_cameras(self._producers(acquisition))), []
                case OpenRequest():
                    return self._opened(request), []
                case GrabRequest():
                    return self._grabbed()
        except TroubleError as error:
            self._clean = False
            return RequestFailed(error.trouble, str(error)), []

    def close(self) -> None:
        """Let everything go; a camera that is gone does not hinder the others."""
        for camera in self._open:
            with suppress(TroubleError):
                camera.close()
        self._open = []
        if self._harvester is not None:
            self._harvester.reset()
            self._harvester = None

    def _producers(self, acquisition: Acquisition) -> Harvester:
        if self._harvester is None:
            self._harvester = Harvester()
            for path in producer_files(acquisition):
                _load(self._harvester, path)
        return self._harvester

    def _opened(self, request: OpenRequest) -> Opened:
        first = request.cameras[0].acquisition
        harvester = self._producers(first)
        seen = seen_cameras(harvester)
        for setup in request.cameras:
            camera = GenicamCamera(harvester, seen, setup.selection, setup.acquisition)
            self._open.append(camera)
            camera.set_up()
        for camera in self._open:
            camera.start()
        self._clean = True
        self._tries = first.tries
        self._fired_by_others = first.trigger.startswith("Line")
        return Opened(tuple(camera.stated() for camera in self._open))

    def _grabbed(self) -> tuple[Answer, list[int]]:
        for _ in range(self._tries):
            images = self._expose()
            if images is not None:
                metas = tuple(meta for meta, _ in images)
                return Grabbed(metas, self._damaged), [block for _, block in images]
            self._damaged += 1
        raise TroubleError(
            Trouble.DAMAGED, f"{self._tries} exposures, and none of them whole and new"
        )

    def _expose(self) -> Sequence[tuple[SentImage, int]] | None:
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
        images = [camera.image() for camera in self._open]
        whole = [one for one in images if one is not None]
        if len(whole) == len(images):
            return whole
        for _, block in whole:
            os.close(block)
        return None


def producer_files(acquisition: Acquisition) -> tuple[Path, ...]:
    """The producers to load; raises ``TroubleError`` when there is none."""
    if acquisition.producers:
        return acquisition.producers
    folders = filter(None, os.environ.get(PRODUCER_PATH, "").split(os.pathsep))
    found = tuple(path for folder in folders for path in sorted(Path(folder).glob("*.cti")))
    if not found:
        raise TroubleError(
            Trouble.PRODUCER,
            f"no producer: neither the cell file nor {PRODUCER_PATH} names a folder with a .cti",
        )
    return found


def _load(harvester: Harvester, path: Path) -> None:
    if not path.is_file():
        raise TroubleError(Trouble.PRODUCER, f"no producer {path}")
    try:
        # Asked of the loader itself: harvesters only logs a file that it cannot load.
        ctypes.CDLL(str(path))
    except OSError as error:
        raise TroubleError(
            Trouble.PRODUCER, f"producer {path} cannot be loaded: {error}"
        ) from error
    harvester.add_file(str(path), check_existence=True, check_validity=True)
