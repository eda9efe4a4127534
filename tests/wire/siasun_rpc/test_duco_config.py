"""Settings of the driver of collaborative arms: what is refused before any hardware is touched."""

import pytest
from pydantic import ValidationError

from cellctl.geometry.euler_order import EulerOrder
from drivers.robot.siasun_rpc.config import SiasunRpcConfig, SiasunRpcStopChannelConfig

CONTROLLER: dict[str, object] = {
    "host": "192.168.0.190",
    "tool": "cellctl_flange",
    "work_frame": "base",
    "euler": "fixed-xyz",
    "stop_word": 31,
    "rearm_word": 32,
}
ARM: dict[str, object] = CONTROLLER | {
    "workspace_min_mm": [-900.0, -900.0, 0.0],
    "workspace_max_mm": [900.0, 900.0, 1200.0],
    "joints_min_deg": [-170.0] * 6,
    "joints_max_deg": [170.0] * 6,
    "max_speed_mm_s": 250.0,
}


def test_the_good_ones() -> None:
    arm = SiasunRpcConfig.model_validate(ARM)
    assert (arm.rpc_port, arm.state_port) == (7003, 2001)
    assert arm.euler is EulerOrder.FIXED_XYZ
    assert arm.servo_period_ms is None
    assert SiasunRpcStopChannelConfig.model_validate(CONTROLLER).rpc_port == 7003


@pytest.mark.parametrize("key", ["host", "tool", "work_frame", "euler"])
def test_what_only_the_site_knows_has_no_default(key: str) -> None:
    settings = {name: value for name, value in ARM.items() if name != key}
    with pytest.raises(ValidationError):
        SiasunRpcConfig.model_validate(settings)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("euler", "zyx"),
        ("tool", ""),
        ("tool", "two words"),
        ("stop_word", 0),
        ("stop_word", 33),
        ("rearm_word", 31),
        ("heartbeat_ms", 10),
        ("heartbeat_ms", 5000),
        ("reply_timeout_s", 0.0),
    ],
)
def test_what_both_refuse(key: str, value: object) -> None:
    for config, good in ((SiasunRpcConfig, ARM), (SiasunRpcStopChannelConfig, CONTROLLER)):
        with pytest.raises(ValidationError):
            config.model_validate(good | {key: value})


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("workspace_min_mm", [900.0, -900.0, 0.0]),
        ("servo_period_ms", 9),
        ("servo_period_ms", 80),
        ("servo_smooth_speed", 0.5),
        ("servo_joint_speed_deg_s", 226.0),
        ("joint_acceleration_percent", 0),
        ("rearm_word", None),
        ("listen_host", "127.0.0.1"),
    ],
)
def test_what_the_arm_refuses(key: str, value: object) -> None:
    with pytest.raises(ValidationError):
        SiasunRpcConfig.model_validate(ARM | {key: value})


def test_an_arm_without_a_guard() -> None:
    arm = SiasunRpcConfig.model_validate(ARM | {"stop_word": None, "rearm_word": None})
    assert arm.stop_word is None
