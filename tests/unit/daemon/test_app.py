"""The record of a run that the end of the daemon aborts says so."""

from cellctl.daemon.app import _end
from cellctl.errors.internal import Unexpected
from cellctl.records.report.acceptance.faults import fault_box
from cellctl.records.store import RunStore
from tests.unit.daemon_rig import DaemonRig


async def _in_contact(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()


async def test_a_signal_in_a_run_is_named_in_its_record(rig: DaemonRig) -> None:
    await _in_contact(rig)
    await _end(rig.unit, rig.archive, ["SIGTERM"], None, None, None)
    record = await rig.record()
    ended = fault_box(record, await rig.archive.do(RunStore.audit_log))
    assert record.head.result == "aborted"
    assert ended is not None
    assert ended.text.startswith("Ended by the command abort, by the end of the daemon (SIGTERM), ")


async def test_a_daemon_that_ends_by_a_fault_names_the_fault_alone(rig: DaemonRig) -> None:
    await _in_contact(rig)
    await _end(rig.unit, rig.archive, [], Unexpected, Unexpected("watch died"), None)
    assert (await rig.record()).head.fault_number == Unexpected.number
    audit = await rig.archive.do(RunStore.audit_log)
    assert "abort" not in [entry.action for entry in audit]


async def test_a_cell_at_rest_is_not_aborted(rig: DaemonRig) -> None:
    await rig.idle()
    await _end(rig.unit, rig.archive, ["SIGINT"], None, None, None)
    audit = await rig.archive.do(RunStore.audit_log)
    assert "abort" not in [entry.action for entry in audit]
