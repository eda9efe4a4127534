"""Cameras on GigE need frames and buffers that the network of a PC does not have by itself."""

from pathlib import Path

from cellctl.config import load_cell
from cellctl.doctor.finding import Finding
from cellctl.doctor.network import network_findings
from tests.unit.doctor.healthy_pc import ROOT, HealthyPc

GIGE_CELL = ROOT / "config" / "deck-gige.toml"


def findings(healthy: HealthyPc) -> dict[str, Finding]:
    cell = load_cell(GIGE_CELL)
    return {found.subject: found for found in network_findings(healthy.pc(), cell)}


def test_jumbo_frames_of_an_interface_are_enough(tmp_path: Path) -> None:
    assert "jumbo frames" not in findings(HealthyPc(tmp_path))


def test_the_loopback_carries_long_frames_for_no_camera(tmp_path: Path) -> None:
    healthy = HealthyPc(tmp_path)
    healthy.write("/sys/class/net/lo/mtu", "65536\n")
    healthy.write("/sys/class/net/eth0/mtu", "1500\n")
    assert "mtu 9000" in findings(healthy)["jumbo frames"].remedy


def test_a_small_receive_buffer(tmp_path: Path) -> None:
    healthy = HealthyPc(tmp_path)
    healthy.write("/proc/sys/net/core/rmem_max", "212992\n")
    assert "rmem_max" in findings(healthy)["receive buffer"].remedy
