from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.unit.cell.bench import make_bench
from tests.unit.procedures.rig import ProcedureRig


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[ProcedureRig]:
    rig = ProcedureRig(make_bench(tmp_path), tmp_path / "store")
    yield rig
    rig.archive.close()
