"""What became of a command is known by its key, also to whoever had no answer."""

from pathlib import Path

from cellctl.records.store import RunStore
from tests.unit.hmi.in_process import Api, bodied


async def test_a_command_that_was_taken_and_one_that_was_refused(api: Api) -> None:
    taken = (await api.get("commands/key-taken-1")).json
    assert (taken["command"], taken["outcome"], taken["refused"]) == ("reset", "taken", "")
    assert (taken["who"], taken["role"]) == ("page:anna@panel-1", "operate")
    assert taken["reason"] == "new shift"
    refused = (await api.get("commands/key-refused-1")).json
    assert (refused["outcome"], refused["refused"]) == ("refused", "not the role")


async def test_without_a_record_nothing_is_claimed(api: Api) -> None:
    reply = await api.get("commands/key-of-nobody")
    assert (reply.status, reply.json["type"]) == (404, "urn:cellctl:command-unknown")
    assert (await api.get("commands/short")).status == 422


async def test_of_a_key_that_was_used_again_the_newest_counts(api: Api, store: Path) -> None:
    # The daemon remembers a thousand keys, the records all of them.
    archive = RunStore(store)
    archive.audit("page:boris@panel-1", "hold", {"key": "key-taken-1", "role": "maintain"})
    archive.close()
    assert (await api.get("commands/key-taken-1")).json["command"] == "hold"


async def test_a_command_goes_to_the_daemon_as_it_came(api: Api) -> None:
    body = bodied({"command": {"request": "abort"}})
    reply = await api.ask("POST", "/api/v1/commands", body, Idempotency_Key="key-of-abort")
    assert (reply.status, reply.json["key"]) == (202, "key-of-abort")
    assert [one.on_behalf.key for one in api.link.asked] == ["key-of-abort"]
