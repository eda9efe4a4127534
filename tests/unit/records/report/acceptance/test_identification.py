"""Which order a run was made on; where none was given, how one is given there."""

from dataclasses import replace

import pytest

from cellctl.records import RunStore
from cellctl.records.entries import MAINTENANCE, AuditEntry
from cellctl.records.report.acceptance.identification import identification
from cellctl.records.report.sections import FactList
from tests.unit.records.conftest import start


def order(store: RunStore, actor: str, *, given: str = "", mode: str = "", kept: str) -> str:
    head = store.run(start(store)).head
    head = replace(head, operator=kept, mode=mode or head.mode)
    detail = {"order": given} if given else {}
    audit = [
        AuditEntry(head.started, "terminal:refused", "start", {"refused": "not in this state"}),
        AuditEntry(head.started, actor, "start", detail),
    ]
    (facts,) = identification(head, (), audit, (), ()).blocks
    assert isinstance(facts, FactList)
    assert dict(facts.facts)["started by"] == actor
    return dict(facts.facts)["order, as given with Start"]


@pytest.mark.parametrize(
    ("actor", "kept", "how"),
    [
        ("terminal:lin", "terminal:lin", "`cellctl start --order ORDER`"),
        ("line:10.0.0.7", "", "register order"),
        ("page:anna@panel-1", "page:anna@panel-1", "the operator page asks for none"),
    ],
)
def test_a_missing_order_is_told_with_how_it_is_given_there(
    store: RunStore, actor: str, kept: str, how: str
) -> None:
    said = order(store, actor, kept=kept)
    assert said.startswith("none was given; ")
    assert how in said
    assert order(store, actor, given="OP-7", kept="OP-7") == "OP-7"


def test_nobody_misses_the_order_of_a_procedure(store: RunStore) -> None:
    assert order(store, "terminal:lin", mode=MAINTENANCE, kept="terminal:lin").startswith("none: ")
