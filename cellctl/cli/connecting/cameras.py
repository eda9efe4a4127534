"""What cameras, heads and trackers are asked: their serial number, and one exposure."""

from cellctl.cell.driver_object import driver_object
from cellctl.cli.connecting.answer import Answer, spread_ms
from cellctl.clock import now_s
from cellctl.config.devices import CameraConfig, TrackerConfig
from cellctl.interfaces import Camera, StereoCamera, TargetTracker
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.interfaces.stereo_camera import StereoPair

_QUESTIONS = 5
OF_A_FAKE_CELL = (
    "a fake cell whose images come through GenTL has no frame servers, and a producer of its own: "
    "ask with the cell file that `cellctl demo --stay` names once it is up"
)
"""Said where a simulated camera or head is not there."""


async def ask_camera(section: str, name: str, config: CameraConfig) -> Answer:
    """Connect, expose once, let go. Its lamp stays as it is; raises what the driver raises."""
    camera: Camera | StereoCamera = driver_object(section, name, config)
    try:
        began_s = now_s()
        await camera.connect()
        connect_s = now_s() - began_s
        serial_number = await camera.serial_number()
        asked_s = now_s()
        taken = await camera.grab()
        image_s = now_s() - asked_s
    finally:
        await camera.let_go()
    if isinstance(taken, StereoPair):
        shape, exposures = taken.left.shape, taken.exposures
    else:
        shape, exposures = taken.pixels.shape, (taken.exposure,) if taken.exposure else ()
    height, width = shape[:2]
    facts = {
        "connected after": f"{connect_s:.2f} s",
        "image": f"{width} x {height} px, complete after {image_s:.2f} s",
        "format": ", ".join(one.pixel_format for one in exposures) or "not told",
        "clock": _clock(exposures, taken.time_s),
    }
    dark = "its lamp was not switched on" if config.light is not None else ""
    return Answer(
        f"{section}.{name}",
        config.driver,
        facts,
        serial_number=serial_number,
        notes=(dark,) if dark else (),
    )


async def ask_tracker(name: str, config: TrackerConfig) -> Answer:
    """Connect, ask for its serial number a few times, let go; raises what the driver raises."""
    tracker: TargetTracker = driver_object("trackers", name, config)
    try:
        began_s = now_s()
        await tracker.connect()
        facts = {"connected after": f"{now_s() - began_s:.2f} s"}
        trips_s = []
        for _ in range(_QUESTIONS):
            asked_s = now_s()
            serial_number = await tracker.serial_number()
            trips_s.append(now_s() - asked_s)
    finally:
        await tracker.let_go()
    facts["answers after"] = spread_ms(trips_s)
    return Answer(f"trackers.{name}", config.driver, facts, serial_number=serial_number)


_OWN_ZERO_S = 1.0
"""A difference beyond this is no delay."""


def _clock(exposures: tuple[ExposureRecord, ...], time_s: float) -> str:
    """Each camera's clock against the monotonic one of this PC, at the last byte of the image."""
    stamps = [one.device_time_ns for one in exposures if one.device_time_ns is not None]
    if not stamps:
        return "not told by this camera"
    offsets = ", ".join(f"{stamp * 1e-9 - time_s:+.3f} s" for stamp in stamps)
    text = f"{offsets} to that of this PC, transfer of the image included"
    if max(abs(stamp * 1e-9 - time_s) for stamp in stamps) > _OWN_ZERO_S:
        text += " (a camera counts from a zero of its own; only the rate matters)"
    if len(stamps) == 2 and stamps[0] != stamps[1]:
        apart_ms = (stamps[0] - stamps[1]) * 1e-6
        text += f"; left {apart_ms:+.3f} ms to right"
    return text
