"""Serial lines and CAN buses that the cell file names."""

import stat
from collections.abc import Iterator
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.config.service_limits import service_limits
from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import Service

_SLOW_LATENCY_MS = 1
"""More is too slow. FTDI and similar adapters collect bytes for 16 ms unless told otherwise; a
sample a millisecond then comes in bunches, and the guard sees each late by that much."""


def device_findings(pc: Pc, service: Service, cell: CellConfig) -> Iterator[Finding]:
    """Whether each is there and the service may use it."""
    limits = service_limits(cell)
    for path in limits.devices:
        yield from _serial_line(pc, service, path)
    for channel in limits.can_channels:
        yield _can_bus(pc, channel)


def _serial_line(pc: Pc, service: Service, device: str) -> Iterator[Finding]:
    place = pc.path(device)
    if not place.exists():
        remedy = "plug it in; `ls /dev/serial/by-id` names what there is, whatever the order"
        yield bad(device, "is not there", remedy)
        return
    state = place.stat()
    groups = {found.gr_gid for name in service.groups if (found := pc.group(name))}
    usable = stat.S_IRGRP | stat.S_IWGRP
    if state.st_gid in groups and state.st_mode & usable == usable:
        yield good(device, f"there, and {service.user} may use it")
    else:
        remedy = f"give it to the group {service.groups[-1]} by a rule of udev"
        yield bad(device, f"{service.user} may not use it", remedy)
    # A name below /dev/serial/by-id is a link, and the kernel's files use the name at its end.
    name = Path(device).resolve().name
    latency = pc.read(f"/sys/bus/usb-serial/devices/{name}/latency_timer")
    if latency is not None and int(latency) > _SLOW_LATENCY_MS:
        yield doubtful(
            f"{device} latency",
            f"the adapter holds bytes back for {latency} ms",
            f"echo 1 | sudo tee /sys/bus/usb-serial/devices/{name}/latency_timer, by a rule of "
            "udev for good",
        )


def _can_bus(pc: Pc, channel: str) -> Finding:
    state = pc.read(f"/sys/class/net/{channel}/operstate")
    if state is None:
        return bad(channel, "there is no such CAN interface", "plug it in, load its driver")
    if state == "down":
        remedy = f"sudo ip link set {channel} up type can bitrate 1000000"
        return bad(channel, "the CAN interface is down", remedy)
    return good(channel, f"the CAN interface is {state}")
