"""A disk whose power can be cut: an ext4 file system in an image on a loop device."""

import fcntl
import os
import shutil
import struct
import subprocess
from pathlib import Path
from types import TracebackType
from typing import Self

_SIZE_MB = 32
_SHUTDOWN = 0x8004587D
"""``EXT4_IOC_SHUTDOWN`` of the kernel's ``fs/ext4/ext4.h``: ``_IOR('X', 125, __u32)``."""
_NO_LOG_FLUSH = 2
"""``EXT4_GOING_FLAGS_NOLOGFLUSH``: not even the journal in memory is written any more."""


class PowerNotCut(Exception):
    """This machine does not let us mount an image or shut it down; the text says what failed."""


class Disk:
    """Mounted while the context lasts; after ``cut_power`` only ``power_on`` makes it usable."""

    def __init__(self, folder: Path) -> None:
        self._image = folder / "disk.img"
        self.mount_point = folder / "disk"

    def __enter__(self) -> Self:
        if os.geteuid() != 0:
            raise PowerNotCut("only root may mount an image")
        if shutil.which("mkfs.ext4") is None:
            raise PowerNotCut("mkfs.ext4 is not installed")
        self.mount_point.mkdir(parents=True)
        with self._image.open("wb") as image:
            image.truncate(_SIZE_MB << 20)
        _run("mkfs.ext4", "-q", "-F", str(self._image))
        self.power_on()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._unmount()

    def power_on(self) -> None:
        """Mount the image; the journal is played as after a real cut. Raises ``PowerNotCut``."""
        _run("mount", "-o", "loop", str(self._image), str(self.mount_point))

    def cut_power(self) -> None:
        """End all writing at once: what the image does not have yet, it never gets."""
        descriptor = os.open(self.mount_point, os.O_RDONLY)
        try:
            fcntl.ioctl(descriptor, _SHUTDOWN, struct.pack("I", _NO_LOG_FLUSH))
        except OSError as error:
            raise PowerNotCut(f"the file system cannot be shut down: {error.strerror}") from error
        finally:
            os.close(descriptor)

    def restart(self) -> None:
        """Come up again after a cut; nobody may have a file open there any more."""
        self._unmount()
        self.power_on()

    def _unmount(self) -> None:
        _run("umount", str(self.mount_point))


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise PowerNotCut(f"{' '.join(command)}: {done.stderr.strip()}")
