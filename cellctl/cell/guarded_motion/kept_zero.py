"""The zero in which a part was left in its place, kept on the disk until the arm has left it.

A guard's zero hides what the part is pressed or pulled with, and the daemon knows how much. A
daemon or guard that is started anew has lost both, and a Reset would pull as if nothing pulled yet.
What the sensor itself read at the zero is kept: it tells how the force has changed since.
"""

import asyncio
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl import log
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.clock import utc_now
from cellctl.files.atomic_files import remove_durably, write_durably
from cellctl.geometry.pose import Array
from cellctl.guard.client import GuardClient
from cellctl.guard.report import GuardSamples

_log = log.get(__name__)

_READING_S = 0.1
"""Length of the stretch of samples that is averaged: 100 at 1 kHz."""
_TURNED_RAD = np.radians(1.0)
"""An arm that has turned by more since the zero feels its load otherwise, by 1.7 % of the weight.
"""
_DISK_S = 2.0
"""Longest wait for the disk. An arm that is to leave does not wait for one that hangs: what is not
kept is told in the log, and after a restart not known."""


@dataclass(frozen=True, slots=True)
class Pressed:
    """What a part is pressed into its place with."""

    inwards: float
    """1 where z of the guard's frame points into the place, -1 where it points out of it."""
    force_n: float
    """Negative where it is pulled."""

    @property
    def axial_n(self) -> float:
        """The same as a force on the part along z of the guard's frame."""
        return -self.inwards * self.force_n


@dataclass(frozen=True, slots=True)
class KeptZero:
    """What was known in the moment of a zero, and what a fault has said since."""

    taken: datetime
    serial: str
    """Of the force sensor."""
    pressed: Pressed
    pull_axis: tuple[float, float, float]
    """Unit vector of z of the guard's frame, in the axes of the sensor."""
    sensor_n: tuple[float, float, float]
    """What the sensor read, in N, with nothing subtracted."""
    base_r_sensor: tuple[float, float, float]
    """Attitude of the sensor in the base as a rotation vector, rad."""
    held: str = ""
    """The fault by which something held the part, empty without one."""

    @classmethod
    def from_json(cls, content: Any) -> "KeptZero":
        """Raises ``ValueError``, ``LookupError`` or ``TypeError`` for anything else."""
        taken = datetime.fromisoformat(content["taken"])
        pressed = Pressed(*(float(content["pressed"][key]) for key in ("inwards", "force_n")))
        vectors = [_three(content[key]) for key in ("pull_axis", "sensor_n", "base_r_sensor")]
        if taken.tzinfo is None or abs(pressed.inwards) != 1.0 or not np.isfinite(pressed.force_n):
            raise ValueError("no zero of a part in its place")
        serial, held = str(content["serial"]), str(content["held"])
        return cls(taken, serial, pressed, vectors[0], vectors[1], vectors[2], held)

    def to_json(self) -> bytes:
        """The whole file."""
        return (json.dumps(asdict(self) | {"taken": self.taken.isoformat()}) + "\n").encode()


async def keep_zero(arm: GuardedRobot, sensor_T_wrench: RigidTransform, pressed: Pressed) -> None:
    """Keep the zero that the guard has just taken in the frame of a part, with what it hides.

    The arm stands. Never raises for a disk.
    """
    if arm.zero_file is None:
        return
    raw = await newest_raw(arm.guard)
    if raw is None:
        return
    kept = KeptZero(
        utc_now(),
        arm.guard.health().sensor_serial,
        pressed,
        _three(sensor_T_wrench.rotation.apply([0.0, 0.0, 1.0])),
        _three(raw[:3]),
        _three(_base_R_sensor(arm).as_rotvec()),
    )
    await _keep(arm.zero_file, kept)


async def note_held(arm: GuardedRobot, held: str) -> None:
    """Add to the kept zero by which fault something has held the part."""
    kept = await kept_zero(arm)
    if arm.zero_file is not None and kept is not None:
        await _keep(arm.zero_file, replace(kept, held=held))


async def forget_zero(arm: GuardedRobot) -> None:
    """The arm has left the place of the part. Never raises for a disk."""
    path = arm.zero_file
    if path is not None:
        await _on_disk(partial(remove_durably, path), path, "zero of a part not forgotten")


async def kept_zero(arm: GuardedRobot) -> KeptZero | None:
    """The zero that was kept; None where there is none, or none that can be read."""
    path = arm.zero_file
    if path is None:
        return None
    try:
        async with asyncio.timeout(_DISK_S):
            text = await asyncio.to_thread(path.read_text, encoding="utf-8")
        return KeptZero.from_json(json.loads(text))
    except FileNotFoundError:
        return None
    except (OSError, TimeoutError, ValueError, LookupError, TypeError) as error:
        _log.warning("zero of a part not known", file=str(path), error=str(error))
        return None


async def pressed_since(arm: GuardedRobot, kept: KeptZero) -> float | None:
    """What the part is pressed with now, N, negative where it is pulled; None where the kept zero
    does not tell: of another sensor, or before the arm was turned.

    Only the change of the sensor's own readings counts, so that no zero of the guard is needed.
    """
    turned = (_base_R_sensor(arm) * Rotation.from_rotvec(kept.base_r_sensor).inv()).magnitude()
    raw = await newest_raw(arm.guard)
    if raw is None or turned > _TURNED_RAD or arm.guard.health().sensor_serial != kept.serial:
        return None
    change_n = float(np.dot(kept.pull_axis, raw[:3] - np.asarray(kept.sensor_n)))
    return kept.pressed.force_n - kept.pressed.inwards * change_n


async def newest_raw(guard: GuardClient) -> Array | None:
    """What the sensor itself reads at this moment, shape (6,); None without samples."""
    raw = (await newest_samples(guard)).raw
    return np.asarray(raw.mean(axis=0)) if len(raw) else None


async def newest_samples(guard: GuardClient) -> GuardSamples:
    """Those of a tenth of a second from now on."""
    # The clock of the loop is the one that stamps samples, also in a loop whose time is simulated.
    begin_s = asyncio.get_running_loop().time()
    await asyncio.sleep(_READING_S)
    return guard.samples(begin_s)


def _base_R_sensor(arm: GuardedRobot) -> Rotation:
    return arm.robot.state().base_T_flange.rotation * arm.flange_T_sensor.rotation


async def _keep(path: Path, kept: KeptZero) -> None:
    write = partial(write_durably, path, kept.to_json())
    await _on_disk(write, path, "zero of a part not kept")


async def _on_disk(change: Callable[[], object], path: Path, failed: str) -> None:
    """Change a file; a disk that fails or hangs is told in the log with the words ``failed``."""
    try:
        async with asyncio.timeout(_DISK_S):
            await asyncio.to_thread(change)
    except (OSError, TimeoutError) as error:
        _log.warning(failed, file=str(path), error=str(error))


def _three(numbers: Any) -> tuple[float, float, float]:
    x, y, z = (float(number) for number in numbers)
    if not np.isfinite([x, y, z]).all():
        raise ValueError("a number is not finite")
    return x, y, z
