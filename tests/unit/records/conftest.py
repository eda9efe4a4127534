from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from cellctl.records import RunStore
from cellctl.records.entries import PRODUCTION


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    store = RunStore(tmp_path / "runs")
    yield store
    store.close()


def start(
    store: RunStore,
    serial: str = "SAT-0001",
    process: str = "deck-to-frame",
    mode: str = PRODUCTION,
    calibrations: Mapping[str, str] | None = None,
) -> int:
    return store.start_run(
        process=process,
        serial=serial,
        recipe_id=1,
        recipe_name="panel 500 x 1000",
        recipe_hash="ab" * 32,
        mode=mode,
        software="cellctl 0.1.0",
        config_hash="cd" * 32,
        calibration_ids={"head_1": "ef" * 32} if calibrations is None else calibrations,
        simulated=True,
        operator="OP-7",
    )
