"""Rendering in a process of its own, so that the world keeps its real time.

The worker keeps the clean pictures of the last scenes: another exposure of an unmoved scene costs
noise only.
"""

import multiprocessing
import os
import signal
import zlib
from collections import OrderedDict
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Final

import cv2
import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.priority import give_way
from fakes.render.connectors.colours import Pixels
from fakes.render.connectors.look import ConnectorLook, lamps_of
from fakes.render.connectors.picture import connector_channels
from fakes.render.image_faults import PICTURE_FAULTS, SCENE_FAULTS
from fakes.render.model import plain_bodies
from fakes.render.optics.canvas import Image
from fakes.render.optics.exposure import taken
from fakes.render.optics.lens import views_of
from fakes.render.optics.sensor import exposed
from fakes.render.options import RenderOptions
from fakes.render.picture import clean_pictures
from fakes.world.connector.scene import SceneConnector, SceneMarks
from fakes.world.scene import CameraScene, Exposure, MonoTruth

_KEPT_SCENES: Final = 3
_CHANNELS: Final = 3
"""Colour channels of a colour camera."""
_CHANNEL_GAINS: Final = (np.float32(1.0), np.float32(0.94), np.float32(0.86))
"""Red, green, blue: bare metal under a warm white lamp, which is all there is to see."""
_kept: "OrderedDict[Any, tuple[Image, ...]]" = OrderedDict()


@dataclass(frozen=True, slots=True)
class Frame:
    """One exposure, ready for the wire."""

    width: int
    height: int
    payload: bytes
    """Rows from the top; of a stereo head the left image, then the right one. Of a colour camera
    red, green and blue of each pixel."""
    crc: int


def make_pool(workers: int = 1) -> ProcessPoolExecutor:
    """Processes for ``render_frame``; shut the pool down when the servers have stopped."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read by the children's numpy
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_initialise)
    for _ in range(workers):
        pool.submit(os.getpid)  # starts a process now, not at the first exposure
    return pool


def render_frame(
    scene: CameraScene, options: RenderOptions, faults: frozenset[str] = frozenset()
) -> Frame:
    """One exposure; ``faults`` are names of ``SCENE_FAULTS`` and ``PICTURE_FAULTS``."""
    # The order is fixed, so that the same set of faults always gives the same picture.
    for name in _in_order(SCENE_FAULTS, faults):
        scene = SCENE_FAULTS[name](scene)
    clean = _clean(scene, options)
    of_connectors = len(clean) == _CHANNELS
    views = views_of(scene.optics) * (_CHANNELS if of_connectors else 1)
    pictures = tuple(
        taken(picture, scene.exposure, view.lens.focal_px[0])
        for picture, view in zip(clean, views, strict=True)
    )
    for name in _in_order(PICTURE_FAULTS, faults):
        pictures = PICTURE_FAULTS[name](pictures)
    # The seed comes with the scene, because the worker has no memory of how many exposures there
    # were.
    rng = np.random.default_rng(scene.noise_seed)
    if of_connectors:
        channels = [exposed(picture, options, rng) for picture in pictures]
        payload = np.stack(channels, axis=2).tobytes()
    elif isinstance(scene.optics, MonoTruth) and scene.optics.colour:
        (picture,) = pictures
        channels = [exposed(gain * picture, options, rng) for gain in _CHANNEL_GAINS]
        payload = np.stack(channels, axis=2).tobytes()
    else:
        payload = b"".join(exposed(picture, options, rng).tobytes() for picture in pictures)
    height, width = pictures[0].shape
    return Frame(width, height, payload, zlib.crc32(payload))


def fingerprint(value: Any) -> Any:
    """A hashable value that is equal for equal scenes."""
    if isinstance(value, RigidTransform):
        return value.as_matrix().tobytes()
    if isinstance(value, tuple):
        return tuple(fingerprint(item) for item in value)
    if is_dataclass(value):
        return tuple(fingerprint(getattr(value, field.name)) for field in fields(value))
    return value


def _clean(scene: CameraScene, options: RenderOptions) -> tuple[Image, ...]:
    # What differs from one exposure to the next of an unmoved scene is no part of the clean
    # picture.
    unmoved = replace(scene, time_s=0.0, noise_seed=0, exposure=Exposure())
    key = fingerprint((unmoved, options))
    pictures = _kept.pop(key, None)
    if pictures is None:
        pictures = _rendered(scene, options)
    _kept[key] = pictures
    while len(_kept) > _KEPT_SCENES:
        _kept.popitem(last=False)
    return pictures


def _rendered(scene: CameraScene, options: RenderOptions) -> tuple[Image, ...]:
    brightness = np.float32(scene.lamp.brightness)
    return tuple(brightness * picture for picture in _nominally_bright(scene, options))


def _nominally_bright(scene: CameraScene, options: RenderOptions) -> tuple[Image, ...]:
    """One picture for each camera, or one for each channel of a colour camera at a connector."""
    connectors = [body for body in scene.bodies if isinstance(body, SceneConnector | SceneMarks)]
    if not connectors:
        return clean_pictures(scene.optics, plain_bodies(scene), options, scene.light_seed)
    (view,) = views_of(scene.optics)
    assert isinstance(scene.optics, MonoTruth)  # no scene shows connectors to a stereo head
    pixels: Pixels = "rgb" if scene.optics.colour else "grey"
    look = ConnectorLook(lamps=lamps_of(scene.lamp), sensor=options)
    return connector_channels(view, connectors, look, pixels, scene.light_seed)


def _in_order(known: Iterable[str], wanted: frozenset[str]) -> list[str]:
    return [name for name in known if name in wanted]


def _initialise() -> None:
    give_way()
    cv2.setNumThreads(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent shuts the pool down
