"""What both ends of an SJL/1 channel must agree on before any other record."""

from ipaddress import IPv6Address, ip_address, ip_network

from drivers.robot.siasun.codec.angles import EULER_ORDERS
from drivers.robot.siasun.codec.records import COMPACT_VERSION, Hello
from drivers.robot.siasun.protocol import VERSION

HELLO_TIMEOUT_S = 2.0
"""A caller that has not greeted by then is sent away: it would keep the robot from its port."""
SESSIONS = 999_999
"""Sessions are numbered from 1 to here and then from 1 again: six digits in the protocol."""


def is_robot(caller: str, robot_address: str) -> bool:
    """Whether a caller's address is that of the robot; every address is where none is named."""
    if not robot_address:
        return True
    address = ip_address(caller)
    # A listener on an IPv6 address sees IPv4 callers as ``::ffff:a.b.c.d``.
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return (mapped or address) in ip_network(robot_address, strict=False)


def refusal(hello: Hello, channel: str, robot: str, max_deadman_s: float) -> tuple[str, str] | None:
    """Why a hello cannot be accepted: the word for the robot and the facts; None when it can."""
    deadman_ok = 0 < hello.deadman_ms <= max_deadman_s * 1000.0
    orders = ", ".join(EULER_ORDERS)
    version_ok = hello.version in (VERSION, COMPACT_VERSION)
    # In the order in which they make sense: of another version the other fields mean nothing, and
    # on a wrong port the name may be right.
    checks = (
        (version_ok, "VERSION", f"job program speaks SJL/{hello.version}"),
        (hello.channel == channel, "CHANNEL", f"channel {hello.channel} on the port of {channel}"),
        (hello.robot == robot, "NAME", f"robot {hello.robot} on the port of {robot}"),
        (
            hello.euler in EULER_ORDERS,
            "CONVENTION",
            f"angles are EUL={hello.euler}, known are {orders}",
        ),
        (hello.unit == "MMDEG", "CONVENTION", f"units are {hello.unit}, not MMDEG"),
        (deadman_ok, "DEADMAN", f"dead man {hello.deadman_ms} ms, limit {max_deadman_s:g} s"),
        (hello.step_max_mm > 0.0, "STEPMAX", "job program allows no step"),
    )
    return next(((word, facts) for passed, word, facts in checks if not passed), None)
