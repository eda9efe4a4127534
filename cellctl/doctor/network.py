"""Whether the PC has a way to everything that the cell file names. No packet is sent."""

import ipaddress
from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.checks.hosts import is_address, written_hosts
from cellctl.config.service_limits import drop_in, service_limits
from cellctl.doctor.finding import Finding, bad, doubtful, good
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import LIMITS_DROP_IN

_LISTENS = ("plc.host", ".settings.listen_host")
_GIGE = "gige"
_JUMBO_BYTES = 9000
_RECEIVE_BYTES = 8_000_000
"""An image of five megapixels and a part of the next, while the PC is busy."""
_ANY = ("0.0.0.0", "::")


def network_findings(pc: Pc, cell: CellConfig) -> Iterator[Finding]:
    """Own addresses, ways to peers, and what cameras need."""
    for key, host in written_hosts(cell).items():
        # To look a name up, packets would have to be sent; and nothing can keep this PC from
        # listening on all of its addresses or from reaching itself.
        if host in _ANY or not is_address(host) or ipaddress.ip_address(host).is_loopback:
            continue
        yield _own(pc, key, host) if key.endswith(_LISTENS) else _way(pc, key, host)
    drivers = {device.driver for _, device in cell.devices().values()}
    if _GIGE in drivers:
        yield from _for_cameras(pc)


def _own(pc: Pc, key: str, host: str) -> Finding:
    if pc.is_own_address(host):
        return good(key, f"{host} is an address of this PC")
    remedy = "give it to the interface of that network, or correct the cell file"
    return bad(key, f"{host} is no address of this PC, so nothing can listen there", remedy)


def _way(pc: Pc, key: str, host: str) -> Finding:
    own = pc.own_address_towards(host)
    if own is None:
        remedy = "an address of that network for one of the interfaces: ip -brief address"
        return bad(key, f"no way to {host}", remedy)
    if _through_gateway(pc.read("/proc/net/route") or "", host):
        found = f"to {host} by way of a gateway, from {own}"
        remedy = "an interface of its own in the network of the cell"
        return doubtful(key, found, remedy)
    return good(key, f"to {host} from {own}, directly")


def _through_gateway(routes: str, host: str) -> bool:
    """Whether the most precise route to a peer has a gateway; IPv4 only.

    ``/proc/net/route`` has network, gateway and mask as little-endian hexadecimal numbers in its
    columns 1, 2 and 7.
    """
    address = ipaddress.ip_address(host)
    if address.version == 6:
        return False
    best, gateway = -1, False
    for line in routes.splitlines()[1:]:
        columns = line.split()
        network, by, mask = (_number(columns[column]) for column in (1, 2, 7))
        # A mask with more ones, which is a more precise route, is the greater number.
        if int(address) & mask == network and mask > best:
            best, gateway = mask, by != 0
    return gateway


def _number(little_endian: str) -> int:
    return int.from_bytes(bytes.fromhex(little_endian), "little")


def limits_finding(pc: Pc, cell: CellConfig, cell_file: str) -> Finding:
    """Whether the service is held to the peers and devices of this very cell file."""
    written = pc.read(LIMITS_DROP_IN)
    renew = f"cellctl service-limits {cell_file} | sudo tee {LIMITS_DROP_IN}"
    if written is None:
        found = "the service may speak to every address"
        return doubtful("limits of the service", found, renew)
    # What was added by hand, such as a network of cameras, is wanted.
    missing = [
        line
        for line in drop_in(cell.name, service_limits(cell)).splitlines()
        if line and not line.startswith("#") and line not in written.splitlines()
    ]
    if missing:
        found = f"the drop-in is not of this cell file: {missing[0]} is missing"
        return bad("limits of the service", found, renew)
    return good("limits of the service", f"{LIMITS_DROP_IN} is of this cell file")


def _for_cameras(pc: Pc) -> Iterator[Finding]:
    buffer = int(pc.read("/proc/sys/net/core/rmem_max") or 0)
    if buffer < _RECEIVE_BYTES:
        yield doubtful(
            "receive buffer",
            f"{buffer / 1e6:.1f} MB: images of GigE cameras are lost while the PC is busy",
            "sudo sysctl -w net.core.rmem_max=33554432",
        )
    # The loopback carries 65536 bytes on every PC, and no camera hangs on it.
    frames = [
        int(pc.read(path) or 0)
        for path in pc.find("/sys/class/net/*/mtu")
        if path.parent.name != "lo"
    ]
    if max(frames, default=0) < _JUMBO_BYTES:
        yield doubtful(
            "jumbo frames",
            f"no interface carries {_JUMBO_BYTES} bytes",
            "sudo ip link set INTERFACE mtu 9000, if cameras and switch carry them too",
        )
