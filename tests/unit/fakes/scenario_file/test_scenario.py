"""What a scenario file may not contradict itself in, and how it finds its scene."""

from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from fakes.scenario_file.scenario import Scenario
from fakes.scenes import registry
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.load import load, open_world
from fakes.scenes.plate.scenario import PlateScenario

CONFIG = Path(__file__).parents[4] / "config"


@pytest.fixture
def small() -> dict[str, Any]:
    return load(CONFIG / "small.scenario.toml").model_dump(exclude_none=True)


def test_the_scene_brings_the_model() -> None:
    assert isinstance(load(CONFIG / "deck.scenario.toml"), DeckScenario)
    assert isinstance(load(CONFIG / "small.scenario.toml"), PlateScenario)


def test_all_devices_are_optional() -> None:
    empty = PlateScenario(scene="plate", hardware_seed=1, control_port=0)
    assert empty.device_names() == []
    assert empty.ports() == {"control": 0}


def test_every_port_has_a_name(small: dict[str, Any]) -> None:
    ports = PlateScenario.model_validate(small).ports()
    assert ports["arm.GRD"] == 7203
    assert (ports["camera"], ports["force"], ports["control"]) == (7211, 4208, 7920)
    assert len(set(ports.values())) == len(ports) == 6


@pytest.mark.parametrize(
    ("section", "name", "key", "value", "said"),
    [
        ("cameras", "camera", "carried_by", "leg", "there is no robot 'leg'"),
        ("cameras", "camera", "optics", "eye", r"there is no \[optics.eye\]"),
        ("force_sensors", "force", "mounted_on", "leg", "force.mounted_on: there is no robot"),
    ],
)
def test_what_is_named_must_be_there(
    small: dict[str, Any], section: str, name: str, key: str, value: str, said: str
) -> None:
    small[section][name][key] = value
    with pytest.raises(ValidationError, match=said):
        PlateScenario.model_validate(small)


def test_a_fixed_camera_has_its_pose_in_the_cell(small: dict[str, Any]) -> None:
    camera = small["cameras"]["camera"]
    del camera["carried_by"]
    with pytest.raises(ValidationError, match="flange_T_camera_mm_deg"):
        PlateScenario.model_validate(small)
    camera["cell_T_camera_mm_deg"] = camera.pop("flange_T_camera_mm_deg")
    assert PlateScenario.model_validate(small).cameras["camera"].carried_by is None


@pytest.mark.parametrize(("name", "said"), [("arm", "two devices"), ("world", "may be called")])
def test_names_tell_devices_apart(small: dict[str, Any], name: str, said: str) -> None:
    small["cameras"][name] = small["cameras"].pop("camera")
    with pytest.raises(ValidationError, match=said):
        PlateScenario.model_validate(small)


def test_a_stereo_head_needs_a_stereo_rig(small: dict[str, Any]) -> None:
    head = small["cameras"].pop("camera")
    del head["colour"], head["lamp"]
    small["stereo_cameras"] = {"head": head}
    with pytest.raises(ValidationError, match="has no stereo rig"):
        PlateScenario.model_validate(small)


def test_cameras_need_an_appearance(small: dict[str, Any]) -> None:
    del small["rendering"]
    with pytest.raises(ValidationError, match=r"\[rendering\]"):
        PlateScenario.model_validate(small)


def test_what_is_no_world_is_no_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    def points(**_: str) -> list[EntryPoint]:
        return [EntryPoint("moon", "fakes.scenario_file.scenario:Scenario", registry.GROUP)]

    monkeypatch.setattr(registry, "entry_points", points)
    with pytest.raises(registry.UnknownScene, match="is not a World"):
        open_world(Scenario(scene="moon", hardware_seed=1, control_port=0), 1)


def test_a_file_may_be_like_another(tmp_path: Path) -> None:
    below = load(CONFIG / "antenna.scenario.toml")
    above = load(CONFIG / "antenna-rpc.scenario.toml")
    arm = above.robots["arm"]
    assert arm.controller == "rpc"
    assert set(arm.ports) == {"RPC", "FRAMES"}, (
        "what a device says takes the place of the lower one"
    )
    changes = {"controller": "protocol", "ports": below.robots["arm"].ports, "selected_load": None}
    assert arm.model_copy(update=changes) == below.robots["arm"]
    assert above.model_copy(update={"robots": below.robots}) == below
    alone = tmp_path / "alone.toml"
    alone.write_text('like = "nobody.toml"', encoding="utf-8")
    with pytest.raises(FileNotFoundError, match=r"nobody\.toml"):
        load(alone)


@pytest.mark.parametrize(
    ("controller", "ports"),
    [
        ("rpc", {"CMD": 1, "STA": 2}),
        ("rpc", {"RPC": 1}),
        ("protocol", {"RPC": 1, "FRAMES": 2}),
        ("jobs", {"CMD": 1, "STA": 2, "RPC": 3}),
        ("jobs", {"CMD": 1}),
    ],
)
def test_a_controller_has_its_own_ports(
    small: dict[str, Any], controller: str, ports: dict[str, int]
) -> None:
    small["robots"]["arm"] |= {"controller": controller, "ports": ports}
    with pytest.raises(ValidationError, match=f"ports of a {controller} controller"):
        PlateScenario.model_validate(small)


@pytest.mark.parametrize(
    ("device", "output", "fits"), [("loop", 1, True), ("loop", 2, False), ("lamp", 1, False)]
)
def test_a_contact_in_a_permit_loop_must_be_there(
    small: dict[str, Any], device: str, output: int, *, fits: bool
) -> None:
    small["digital_ios"] = {"loop": {"port": 1, "outputs": [0, 1], "watchdog_ms": 500}}
    small["robots"]["arm"]["permit"] = {"device": device, "output": output}
    if fits:
        assert PlateScenario.model_validate(small).robots["arm"].permit is not None
        return
    with pytest.raises(ValidationError, match=f"arm.permit: there is no output {output} of"):
        PlateScenario.model_validate(small)


@pytest.mark.parametrize(
    ("name", "arm", "key", "value"),
    [
        ("antenna.scenario.toml", "arm", "selected_load", {"mass_kg": 1.0, "com_mm": (0, 0, 0)}),
        ("antenna-rpc.scenario.toml", "arm", "permit", {"device": "loop", "output": 0}),
    ],
)
def test_an_arm_has_only_what_its_kind_has(
    name: str, arm: str, key: str, value: dict[str, Any]
) -> None:
    scenario = load(CONFIG / name)
    written = scenario.model_dump(exclude_none=True)
    written["robots"][arm][key] = value
    with pytest.raises(ValidationError, match=f"{arm}.{key}: "):
        type(scenario).model_validate(written)
