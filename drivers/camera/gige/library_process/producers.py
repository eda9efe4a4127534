"""The producers of one process, and the cameras that they see.

Each producer has a harvester of its own: one that cannot be used takes no other with it.
"""

import ctypes
import logging
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from genicam import gentl
from harvesters.core import Harvester, ImageAcquirer, ParameterKey, ParameterSet

from drivers.camera.gige.library_process.delivered import said
from drivers.camera.gige.library_process.network import Network, network
from drivers.camera.gige.library_process.trouble import GENICAM_ERRORS, TroubleError, in_words
from drivers.camera.gige.protocol import CameraState, SeenCamera, Trouble

_STATUS = gentl.DEVICE_ACCESS_STATUS_LIST
_TAKEN = (
    _STATUS.DEVICE_ACCESS_STATUS_READONLY,  # another program has it and lets others look
    _STATUS.DEVICE_ACCESS_STATUS_BUSY,
    _STATUS.DEVICE_ACCESS_STATUS_OPEN_READWRITE,
    _STATUS.DEVICE_ACCESS_STATUS_OPEN_READONLY,
)


@dataclass(frozen=True, slots=True)
class Found:
    """A camera, and how it is opened."""

    seen: SeenCamera
    harvester: Harvester
    place: int
    """Place in the harvester's list."""

    def create(self) -> ImageAcquirer:
        """Open it; raises the exceptions of the standard's libraries."""
        # Chunks are read by the driver, for a chunk that cannot be read costs no image there.
        own = ParameterSet({ParameterKey.ENABLE_AUTO_CHUNK_DATA_UPDATE: False})
        return self.harvester.create(self.place, config=own)


class Producers:
    """Loaded by the first ``look``, in the order of their files."""

    def __init__(self, files: Sequence[Path]) -> None:
        self._files = tuple(files)
        self._harvesters: list[Harvester] = []
        self.unusable: tuple[str, ...] = ()
        """Which producers cannot be used, and why, by the last ``look``."""

    def look(self) -> tuple[Found, ...]:
        """All cameras that there are now. Closes those that are open.

        Raises ``TroubleError`` when none of the producers can be used.
        """
        self.close()
        found: list[Found] = []
        unusable: list[str] = []
        for path in self._files:
            try:
                found += self._look_with(path)
            except TroubleError as error:
                unusable.append(str(error))
        self.unusable = tuple(unusable)
        if len(unusable) == len(self._files):
            raise TroubleError(Trouble.PRODUCER, "; ".join(unusable))
        return tuple(found)

    def close(self) -> None:
        """Unload them, also those whose cameras are gone."""
        for harvester in self._harvesters:
            _unload(harvester)
        self._harvesters = []

    def _look_with(self, path: Path) -> list[Found]:
        _require_loadable(path)
        harvester = Harvester()
        self._harvesters.append(harvester)
        harvester.add_file(str(path))
        with _Warnings() as warnings:
            harvester.update()
        infos = harvester.device_info_list
        if not infos and warnings.texts:
            # harvesters goes on with what is left, here nothing, and tells it to its log only.
            text = f"producer {path} cannot be used: {warnings.texts[0]}"
            raise TroubleError(Trouble.PRODUCER, text)
        networks = {id(info.parent): network(info.parent.node_map) for info in infos}
        return [
            Found(_seen(path, info, networks[id(info.parent)]), harvester, place)
            for place, info in enumerate(infos)
        ]


def _unload(harvester: Harvester) -> None:
    for acquirer in tuple(harvester.image_acquirers):
        # With a camera that is gone, harvesters fails where it stops the acquisition; called again,
        # it goes on from there.
        for _ in range(2):
            with suppress(*GENICAM_ERRORS):
                acquirer.destroy()
    with suppress(*GENICAM_ERRORS):  # of a lost camera that cannot even be closed: the process ends
        harvester.reset()


def _require_loadable(path: Path) -> None:
    if not path.is_file():
        raise TroubleError(Trouble.PRODUCER, f"no producer {path}")
    try:
        # Asked of the loader itself: harvesters only logs a file that it cannot load.
        ctypes.CDLL(str(path))
    except OSError as error:
        text = f"producer {path} cannot be loaded: {error}"
        raise TroubleError(Trouble.PRODUCER, text) from error


def _seen(path: Path, info: Any, there: Network) -> SeenCamera:
    def text(name: str) -> str:
        # Only a few of these are mandatory.
        return said(lambda: str(getattr(info, name)), "")

    name = text("id_")
    address = there.address(name, text("display_name"))
    status = said(lambda: int(info.access_status), int(_STATUS.DEVICE_ACCESS_STATUS_UNKNOWN))
    return SeenCamera(
        producer=str(path),
        id=name,
        vendor=text("vendor"),
        model=text("model"),
        serial_number=text("serial_number"),
        user_name=text("user_defined_name"),
        ip_address="" if address is None else str(address),
        subnets=tuple(map(str, there.subnets)),
        state=_state(status, reached=there.reaches(address)),
    )


def _state(status: int, *, reached: bool | None) -> CameraState:
    if status in _TAKEN:
        return CameraState.IN_USE
    if reached is False:
        return CameraState.OUT_OF_REACH
    if status == _STATUS.DEVICE_ACCESS_STATUS_NOACCESS:
        # Most producers say it of a camera in another subnet, some of one that is in use.
        return CameraState.IN_USE if reached else CameraState.OUT_OF_REACH
    return CameraState.FREE


class _Warnings(logging.Handler):
    """A context that notes what harvesters warns of, which its own log is set to keep quiet."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: list[str] = []
        self._logger = logging.getLogger("harvesters.core")
        self._level = self._logger.level

    def emit(self, record: logging.LogRecord) -> None:
        error = record.msg
        self.texts.append(in_words(error) if isinstance(error, Exception) else str(error))

    def __enter__(self) -> Self:
        self._logger.addHandler(self)
        self._logger.setLevel(logging.WARNING)
        return self

    def __exit__(self, *_: object) -> None:
        self._logger.setLevel(self._level)
        self._logger.removeHandler(self)
