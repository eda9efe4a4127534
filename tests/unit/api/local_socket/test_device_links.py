"""A device with which something is wrong is not called well."""

from cellctl.api.local_socket.device_links import device_links
from cellctl.errors.link import DeviceAway, LinkLost, ReplyTimeout
from cellctl.errors.vision import ImageSizeMismatch
from tests.unit.daemon_rig import DaemonRig


async def test_a_latched_fault_of_a_link_counts_though_the_device_answered_since(
    rig: DaemonRig,
) -> None:
    await rig.idle()
    cell = rig.bench.as_cell
    late = ReplyTimeout("head_1, frame server 127.0.0.1:4001: no complete reply within 2 s")
    links = device_links(
        cell, (late, LinkLost("head_12: closed"), ImageSizeMismatch("head_2, left"))
    )
    assert links["stereo_cameras.head_1"] == str(late)
    assert links["stereo_cameras.head_2"] == ""
    assert set(device_links(cell, ()).values()) == {""}
    rig.bench.cell.unanswered["head_1"] = away = DeviceAway("head_1: no answer within 2 s")
    assert device_links(cell, (late,))["stereo_cameras.head_1"] == str(away)
