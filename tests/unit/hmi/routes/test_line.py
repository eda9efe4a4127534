"""The registers of the line PLC by the API."""

from typing import Any

import pytest

from cellctl.clock import now_s
from tests.unit.hmi.in_process import Api


def register(name: str, writer: str, value: Any) -> dict[str, Any]:
    return {
        "address": 2,
        "name": name,
        "text": f"what {name} means",
        "unit": "",
        "writer": writer,
        "value": value,
    }


MAP = [
    register("state", "cell", 4),
    register("serial", "cell", "SAT-1"),
    register("cmd_seq", "line", "7"),
]


async def test_registers_are_told_with_the_state_of_the_line(api: Api) -> None:
    await api.describe(registers=MAP)
    told = (await api.get("plc/registers")).json
    assert told["registers"] == MAP
    assert (told["line_alive"], told["control"], told["heartbeat_age_s"]) == (False, "shared", 0.3)
    for writer, names in (("cell", ["state", "serial"]), ("line", ["cmd_seq"])):
        found = (await api.get(f"plc/registers?writer={writer}")).json["registers"]
        assert [one["name"] for one in found] == names
    assert (await api.get("plc/registers?writer=me")).status == 422


async def test_one_register_by_its_name(api: Api) -> None:
    await api.describe(registers=MAP)
    assert (await api.get("plc/registers/serial")).json["value"] == "SAT-1"
    unknown = await api.get("plc/registers/SERIAL")
    assert (unknown.status, unknown.json["type"]) == (404, "urn:cellctl:register-unknown")


@pytest.mark.parametrize("path", ["plc/registers", "plc/registers/state", "procedures"])
async def test_what_the_cell_said_long_ago_is_no_answer(api: Api, path: str) -> None:
    api.parts.hub.snapshot["mono_s"] = now_s() - 2.0
    reply = await api.get(path)
    assert (reply.status, reply.json["type"]) == (503, "urn:cellctl:daemon-away")
    assert reply.headers["retry-after"] == "1"


@pytest.mark.parametrize("method", ["POST", "PUT", "PATCH", "DELETE"])
async def test_no_register_can_be_written(api: Api, method: str) -> None:
    reply = await api.ask(method, "/api/v1/plc/registers/state", b"{}")
    assert (reply.status, reply.headers["allow"]) == (405, "GET")
