"""What a run was made with can be read from its record, and its hashes cover all of it."""

import json
import shutil
from hashlib import sha256
from pathlib import Path

import pytest

from cellctl.config import CellConfig
from cellctl.config.load import cell_from_document
from cellctl.errors.records.store import RecordNotWritten
from cellctl.errors.vision import FeatureFileInvalid
from cellctl.packml.state import State
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.entries import RunRecord, RunResult
from cellctl.records.files.artefacts import ArtefactFolder
from cellctl.records.store import RunStore
from cellctl.runtime.jobs.provenance import Provenance, provenance
from cellctl.runtime.jobs.record import JobRecord
from cellctl.version import software
from tests.rigs.shipped import shipped_cell
from tests.unit.cell.bench import CELL_FILE, Bench, start_command
from tests.unit.daemon_rig import DaemonRig


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(CELL_FILE.parent / "features", tmp_path / "features")
    return tmp_path


@pytest.fixture(scope="module")
def config() -> CellConfig:
    return shipped_cell(CELL_FILE.name)


def made_with(config: CellConfig, folder: Path) -> Provenance:
    return provenance(config, folder, config.recipes[0])


def test_the_hash_of_a_recipe_covers_its_feature_files(config: CellConfig, folder: Path) -> None:
    before = made_with(config, folder)
    assert made_with(config, folder).recipe_hash == before.recipe_hash
    with (folder / "features" / "deck.toml").open("a") as file:
        file.write("# another drawing\n")
    after = made_with(config, folder)
    assert after.recipe_hash != before.recipe_hash
    assert after.cell_hash == before.cell_hash


def test_a_feature_file_that_went_away_is_a_fault(config: CellConfig, folder: Path) -> None:
    (folder / "features" / "frame.toml").unlink()
    with pytest.raises(FeatureFileInvalid, match=r"frame\.toml"):
        made_with(config, folder)


async def recorded(bench: Bench, archive: AsyncRunStore) -> RunRecord:
    record = JobRecord(bench.as_cell, archive, start_command())
    number = await record.open(bench.cell.config.recipes[0], "PRODUCTION", ())
    await record.close(RunResult.GOOD, None)
    return await archive.do(RunStore.run, number)


async def test_cell_recipe_and_feature_files_are_in_the_record(
    bench: Bench, tmp_path: Path
) -> None:
    archive = AsyncRunStore(tmp_path / "store")
    try:
        run = await recorded(bench, archive)
        files = {a.name: archive._store.artefacts.get(a.sha256) for a in run.artefacts}
    finally:
        archive.close()
    assert set(files) == {
        "cell.json", "motion.mcap", "recipe.json", "frame_features.toml", "deck_features.toml",
    }  # fmt: skip
    assert run.head.config_hash == sha256(files["cell.json"]).hexdigest()
    assert run.head.recipe_hash == sha256(files["recipe.json"]).hexdigest()
    assert cell_from_document(json.loads(files["cell.json"])) == bench.cell.config
    recipe = json.loads(files["recipe.json"])
    for name in ("frame_features.toml", "deck_features.toml"):
        assert recipe["sha256"][name] == sha256(files[name]).hexdigest()
    assert run.head.software == software()


async def test_a_run_whose_files_could_not_be_kept_is_closed_all_the_same(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_folder: ArtefactFolder, _data: bytes) -> str:
        raise RecordNotWritten("disk full")

    monkeypatch.setattr(ArtefactFolder, "put", full)
    archive = AsyncRunStore(tmp_path / "store")
    record = JobRecord(bench.as_cell, archive, start_command())
    try:
        with pytest.raises(RecordNotWritten) as error:
            await record.open(bench.cell.config.recipes[0], "PRODUCTION", ())
        await record.close(RunResult.ABORTED, error.value)
        run = await archive.do(RunStore.run, 1)
    finally:
        archive.close()
    assert (run.head.result, run.head.fault_number) == ("aborted", 803)


async def test_a_drawing_that_is_saved_while_a_run_is_prepared_by_the_one_before(
    rig: DaemonRig, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The record would show a drawing by which nothing was measured."""
    monkeypatch.setattr(rig.bench.cell, "folder", folder)
    head = rig.bench.cell.stereo_cameras["head_1"]
    serial_number = head.serial_number

    async def saved_meanwhile() -> str:
        with (folder / "features" / "deck.toml").open("a") as file:
            file.write("# another drawing\n")
        return str(await serial_number())

    monkeypatch.setattr(head, "serial_number", saved_meanwhile)
    await rig.started()
    await rig.to(State.STOPPED)
    (fault,) = rig.unit.machine.faults
    assert isinstance(fault, FeatureFileInvalid)
    assert "deck_features.toml: changed" in fault.detail
    assert await rig.runs() == []
    monkeypatch.undo()
