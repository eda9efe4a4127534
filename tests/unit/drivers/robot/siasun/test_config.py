"""Settings of the SIASUN driver: what is refused before any hardware is touched."""

import pytest
from pydantic import ValidationError

from drivers.robot.siasun.config import SiasunConfig, SiasunStopChannelConfig

GOOD: dict[str, object] = {
    "robot_name": "SR500A",
    "command_port": 7001,
    "state_port": 7002,
    "workspace_min_mm": [900.0, -900.0, 300.0],
    "workspace_max_mm": [2500.0, 900.0, 2200.0],
    "joints_min_deg": [-90.0, -130.0, 20.0, -180.0, -30.0, -30.0],
    "joints_max_deg": [90.0, 20.0, 144.0, 180.0, 120.0, 210.0],
    "max_speed_mm_s": 250.0,
}


def test_the_good_one() -> None:
    assert SiasunConfig.model_validate(GOOD).listen_host == "127.0.0.1"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("robot_name", "sr500a"),
        ("robot_name", "X" * 17),
        ("command_port", 0),
        ("command_port", 7002),
        ("workspace_min_mm", [2500.0, -900.0, 300.0]),
        ("workspace_min_mm", [float("nan"), -900.0, 300.0]),
        ("workspace_max_mm", [2500.0, 900.0]),
        ("max_speed_mm_s", 0.0),
        ("max_speed_mm_s", float("inf")),
        ("max_joint_speed_percent", 101),
        ("max_step_mm", -0.1),
        ("joints_min_deg", [361.0] * 6),
        ("stale_s", 0.0),
        ("max_deadman_s", float("nan")),
        ("speed", 100.0),
    ],
)
def test_what_is_refused(key: str, value: object) -> None:
    with pytest.raises(ValidationError):
        SiasunConfig.model_validate(GOOD | {key: value})


@pytest.mark.parametrize("bound", ["workspace_min_mm", "joints_min_deg", "joints_max_deg"])
def test_bounds_are_not_optional(bound: str) -> None:
    with pytest.raises(ValidationError, match=bound):
        SiasunConfig.model_validate({key: GOOD[key] for key in GOOD if key != bound})


def test_the_guard_needs_its_own_port() -> None:
    with pytest.raises(ValidationError, match="guard_port"):
        SiasunStopChannelConfig.model_validate({"robot_name": "SR500A"})


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.20.1", "::"])
def test_a_port_that_others_reach_needs_the_address_of_the_robot(host: str) -> None:
    with pytest.raises(ValidationError, match="robot_address"):
        SiasunConfig.model_validate(GOOD | {"listen_host": host})
    named = SiasunConfig.model_validate(
        GOOD | {"listen_host": host, "robot_address": "192.168.20.11"}
    )
    assert named.robot_address == "192.168.20.11"


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "localhost"])
def test_a_port_of_this_pc_alone_needs_none(host: str) -> None:
    assert SiasunConfig.model_validate(GOOD | {"listen_host": host}).robot_address == ""


@pytest.mark.parametrize("address", ["192.168.20.999", "robot.local"])
def test_the_address_of_the_robot_is_an_address(address: str) -> None:
    with pytest.raises(ValidationError, match=r"robot_address|IPv4"):
        SiasunConfig.model_validate(GOOD | {"robot_address": address})
