"""An exported run, read by the official reader and held against the record."""

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.records.store import RecordNotWritten, RunUnknown
from cellctl.records import RunStore
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entries import Document, RunRecord, RunResult
from cellctl.records.files.mcap_reading import read_mcap
from cellctl.records.files.unfinished import MOTION
from cellctl.records.run_mcap.export import ExportedRun, export_mcap
from cellctl.records.run_mcap.images import ImageForm
from cellctl.records.run_mcap.layout import layout_for
from tests.unit.records.conftest import start
from tests.unit.records.run_mcap.layout_fit import misfits
from tests.unit.records.run_mcap.moved_run import (
    BASE_T_C1,
    FILE,
    PIXELS,
    PLACE,
    REPORTS,
    RIMS,
    SAMPLES,
    VIEW,
    closed_run,
    motion,
    open_run,
)
from tests.unit.records.run_mcap.reading import Content, read

PAGE = Path(__file__).parents[4] / "docs" / "recordings.md"


@dataclass(frozen=True)
class Exported:
    """A run that is only looked at: one for all tests."""

    store: RunStore
    found: ExportedRun
    content: Content
    record: RunRecord


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Exported]:
    folder = tmp_path_factory.mktemp("exported")
    store = RunStore(folder / "runs")
    run = closed_run(store)
    found = export_mcap(store, run, folder / "run.mcap")
    yield Exported(store, found, read(found.path), store.run(run))
    store.close()


def test_times_never_go_back_and_lie_within_the_run(exported: Exported) -> None:
    found, content = exported.found, exported.content
    times = [time for _, time, _ in content.messages]
    assert times == sorted(times)
    assert (times[-1] - times[0]) / 1e9 < 60.0
    assert found.missing == ()
    assert found.messages == Counter(topic for topic, _, _ in content.messages)


def test_what_was_recorded_is_there_unchanged(exported: Exported) -> None:
    content, record = exported.content, exported.record
    (artefact,) = (one for one in record.artefacts if one.name == MOTION)
    recorded = read_mcap(exported.store.artefacts.get(artefact.sha256)).messages
    for topic in {one.topic for one in recorded}:
        assert content.of(topic) == [dict(one.values) for one in recorded if one.topic == topic]
    assert len(content.of("/force/force/raw")) == SAMPLES
    assert len(content.of("/robots/aux_1/report")) == REPORTS
    assert content.of("/unit/state")[0]["state"] == "STARTING"
    assert content.of("/registers/input")[0]["serial_echo"] == "SAT-0042"


def test_robots_and_calibrations_make_one_tree(exported: Exported) -> None:
    content = exported.content
    parents: dict[str, str] = {}
    found = [one for message in content.of("/tf") for one in message.transforms]
    for one in found:
        assert parents.setdefault(one.child_frame_id, one.parent_frame_id) == one.parent_frame_id
    # The robot that has reported the recorded pose has the frames that the record names.
    assert parents == {"c1": "base", "flange": "base", "aux_1/flange": "aux_1/base"}
    (camera,) = (one for one in found if one.child_frame_id == "c1")
    assert camera.translation.x == pytest.approx(BASE_T_C1[0, 3] / 1000)
    assert (camera.rotation.z, camera.rotation.w) == pytest.approx((0.5**0.5, 0.5**0.5))
    flange = next(one for one in found if one.child_frame_id == "flange")
    place = (flange.translation.x, flange.translation.y, flange.translation.z)
    assert place == pytest.approx([value / 1000 for value in PLACE[:3]])


def test_targets_and_recorded_poses_are_poses_in_their_frames(exported: Exported) -> None:
    content, record = exported.content, exported.record
    (target,) = content.of("/robots/main/target")
    assert target.frame_id == "base"
    assert target.pose.position.z == pytest.approx(PLACE[2] / 1000)
    (frame,) = content.of("/poses/measured/frame")
    assert frame.frame_id == "c1"
    assert frame.pose.position.x == pytest.approx(12.34e-3)
    assert [one["key"] for one in content.of("/poses")] == [one.key for one in record.poses]
    deck = content.of("/poses")[1]
    assert deck["detail"]["residuals_mm"]["P5"] == [0.0, 0.0, 0.009]


def test_an_image_has_every_pixel_and_its_rims_lie_on_it(exported: Exported) -> None:
    content, record = exported.content, exported.record
    (image,) = content.of(f"/images/{VIEW}")
    assert (image.encoding, image.frame_id) == ("mono8", VIEW)
    pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    assert np.array_equal(pixels, PIXELS)
    (drawn,) = content.of(f"/images/{VIEW}/annotations")
    assert drawn.timestamp.ToNanoseconds() == image.timestamp.ToNanoseconds()
    assert [one.text for one in drawn.texts] == ["P1 3.4 µm", "P2 41.0 µm, not used"]
    outline = np.array([(point.x, point.y) for point in drawn.points[0].points])
    # The viewer counts from the corner of the first pixel.
    assert outline.mean(axis=0) == pytest.approx(np.array(RIMS[0].ellipse_centre_px) + 0.5)
    assert np.ptp(outline, axis=0).max() < 2 * RIMS[0].semi_axes_px[0] + 1e-9
    (numbers,) = content.of(f"/images/{VIEW}/rims")
    assert numbers["rims"][1]["residual_um"] == 41.0
    assert [one.name for one in record.artefacts if one.media_type == "application/zstd"] == [FILE]


def test_what_was_found_and_what_happened_is_that_of_the_record(
    exported: Exported,
) -> None:
    content, record = exported.content, exported.record
    passes = content.of("/passes")
    assert [one["components"]["X"]["value"] for one in passes] == [
        entry.components[0].value for entry in record.passes
    ]
    assert passes[0]["components"]["rz"]["unit"] == "°"
    assert [one["key"] for one in content.of("/figures")] == [one.key for one in record.figures]
    begins = [one["label"] for one in content.of("/steps") if one["event"] == "begins"]
    assert begins == [phase.label for phase in record.phases]
    assert [one["number"] for one in content.of("/alarms")] == [512]
    assert [(one["action"], one["who"]) for one in content.of("/commands")] == [
        ("start", "line:10.0.0.5")
    ]
    words = " | ".join(one.message for one in content.of("/log"))
    for expected in ("start by line", "state EXECUTE", "creeps", "F512", "SIMULATED", "good"):
        assert expected in words, expected
    assert content.metadata["run"]["serial"] == "SAT-0042"
    assert record.seal is not None
    assert content.metadata["run"]["seal"] == record.seal.hash
    assert json.loads(content.attachments["run.json"])["number"] == record.head.number


def test_a_force_curve_begins_where_it_says(exported: Exported) -> None:
    content, record = exported.content, exported.record
    felt = [time for topic, time, _ in content.messages if topic == "/contact/force"]
    (artefact,) = (one for one in record.artefacts if one.name == "force-1.mcap")
    # The sample's file says of its begin what is the time of its end, as first releases did.
    assert felt[-1] / 1e9 == pytest.approx(artefact.time.timestamp(), abs=1.0)
    assert (felt[-1] - felt[0]) / 1e9 == pytest.approx(4.0, abs=0.01)


def test_images_can_be_small_or_left_out(store: RunStore, tmp_path: Path) -> None:
    run = closed_run(store)
    small = read(export_mcap(store, run, tmp_path / "j.mcap", ImageForm.JPEG).path)
    (image,) = small.of(f"/images/{VIEW}")
    assert image.format == "jpeg"
    assert image.data.startswith(b"\xff\xd8")
    none = read(export_mcap(store, run, tmp_path / "n.mcap", ImageForm.NONE).path)
    assert not none.of(f"/images/{VIEW}")
    assert none.of(f"/images/{VIEW}/annotations")
    assert {one for one in small.schemas if "pictures" in one}
    assert not {one for one in none.schemas if "pictures" in one}


def test_an_interrupted_run_exports_what_there_is_and_says_what_is_missing(
    store: RunStore, tmp_path: Path
) -> None:
    run = open_run(store)
    whole = motion()
    with store.open_recording(run) as file:
        file.write(whole[: int(len(whole) * 0.4)])
    store.mark_interrupted()
    found = export_mcap(store, run, tmp_path / "run.mcap")
    content = read(found.path)
    assert any(text.startswith("motion.mcap") for text in found.missing)
    assert content.metadata["run"]["result"] == "interrupted"
    assert set(content.metadata["missing"].values()) == set(found.missing)
    assert any("missing: motion.mcap" in one.message for one in content.of("/log"))
    assert content.of("/poses")


def test_an_open_run_says_that_it_is_open(store: RunStore, tmp_path: Path) -> None:
    found = export_mcap(store, open_run(store), tmp_path / "run.mcap")
    assert any("still open" in text for text in found.missing)
    assert any(text.startswith("motion.mcap") for text in found.missing)
    head = read(found.path).metadata["run"]
    assert (head["result"], head["part_verdict"]) == ("open", "open")


@pytest.mark.parametrize("name", [MOTION, FILE, "force-1.mcap"])
@pytest.mark.parametrize("damage", ["gone", "changed"])
def test_a_damaged_file_is_left_out_and_named(
    store: RunStore, tmp_path: Path, name: str, damage: str
) -> None:
    run = closed_run(store)
    (artefact,) = (one for one in store.run(run).artefacts if one.name == name)
    path = store.artefacts.path(artefact.sha256)
    if damage == "gone":
        path.unlink()
    else:
        path.write_bytes(path.read_bytes()[:-20])
    found = export_mcap(store, run, tmp_path / "run.mcap")
    assert [text.split(":")[0] for text in found.missing] == [name]
    assert read(found.path).of("/figures")


def test_the_metadata_tell_a_part_that_its_gauge_has_turned(
    store: RunStore, tmp_path: Path
) -> None:
    run = open_run(store)
    store.add(run, Document(GAUGE_HOLES, {"P1": {"least_mm": 5.8, "most_mm": 6.0}}))
    store.close_run(run, RunResult.GOOD)

    def verdict() -> tuple[str, str]:
        head = read(export_mcap(store, run, tmp_path / "run.mcap").path).metadata["run"]
        return head["result"], head["part_verdict"]

    assert verdict() == ("good", "good")
    store.set_gauge(run, "P1", 5.7, "OP-7")
    assert verdict() == ("good", "bad")


def test_a_run_without_images_motion_or_figures_is_a_file_all_the_same(
    store: RunStore, tmp_path: Path
) -> None:
    content = read(export_mcap(store, start(store), tmp_path / "run.mcap").path)
    assert set(content.schemas) == {"/log"}


def test_no_run_and_no_place_are_told(store: RunStore, tmp_path: Path) -> None:
    with pytest.raises(RunUnknown):
        export_mcap(store, 7, tmp_path / "run.mcap")
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordNotWritten):
        export_mcap(store, start(store), tmp_path / "file" / "run.mcap")


def rows() -> dict[str, str]:
    """Topic and schema of each row of the page."""
    text = PAGE.read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `(/[^`]+)` \| (\S+) \|", text, re.MULTILINE))


def test_the_page_lists_every_topic_with_its_schema(exported: Exported) -> None:
    content = exported.content
    table = rows()
    patterns = {name: re.sub(r"[A-Z]{2,}", "[^/]+", name) for name in table}
    used = set()
    for topic, schema in content.schemas.items():
        matching = [name for name, pattern in patterns.items() if re.fullmatch(pattern, topic)]
        assert len(matching) == 1, topic
        assert table[matching[0]] == schema
        used.add(matching[0])
    assert used == set(table)


@pytest.mark.parametrize("form", list(ImageForm))
def test_the_layout_fits_what_the_run_has(
    exported: Exported, tmp_path: Path, form: ImageForm
) -> None:
    found, content = exported.found, exported.content
    if form is not ImageForm.LOSSLESS:
        number = exported.record.head.number
        found = export_mcap(exported.store, number, tmp_path / "run.mcap", form)
        content = read(found.path)
    layout = json.loads(layout_for(found.messages, found.frames))
    assert misfits(layout, content) == []
    named = set(layout["configById"])
    pictured = set() if form is ImageForm.NONE else {f"Image!{VIEW}"}
    assert named >= pictured | {"Plot!contact-force", "Plot!force-force-raw", "Plot!passes"}


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("/contact/force.fx_n", "/contact/force.fx", "has no number"),
        ("/passes.components.X.value", "/passes.components.X.unit", "has no number"),
        ("/unit/state.mode", "/unit/state.modus", "has no state"),
        ('"imageTopic": "/images/', '"imageTopic": "/image/', "is no image"),
        ("/annotations", "/rims", "has no annotations"),
        ('"followTf": "base"', '"followTf": "world"', "no frame world"),
        ('"/log"', '"/steps"', "is no log"),
        ("RosOut!log", "Log!log", "is no panel"),
    ],
)
def test_a_layout_that_does_not_fit_is_noticed(
    exported: Exported, old: str, new: str, problem: str
) -> None:
    text = layout_for(exported.found.messages, exported.found.frames)
    assert old in text
    assert problem in " ".join(misfits(json.loads(text.replace(old, new)), exported.content))


def test_a_layout_of_a_run_without_images_has_no_image_panels() -> None:
    layout = json.loads(layout_for(["/log", "/unit/state"], ()))
    assert set(layout["configById"]) == {"3D!scene", "StateTransitions!states", "RosOut!log"}


def test_a_run_that_names_no_robot_is_looked_at_from_the_first_of_all() -> None:
    frames = ("main/flange", "main/base", "aux_1/base")
    layout = json.loads(layout_for(["/log"], frames))
    assert layout["configById"]["3D!scene"]["followTf"] == "aux_1/base"
    assert "followTf" not in json.loads(layout_for(["/log"], ()))["configById"]["3D!scene"]


def test_a_file_that_somebody_interrupts_is_not_left_behind(
    store: RunStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_sha256: str) -> bytes:
        raise KeyboardInterrupt

    number = closed_run(store)
    monkeypatch.setattr(store.artefacts, "get", interrupted)
    with pytest.raises(KeyboardInterrupt):
        export_mcap(store, number, tmp_path / "out" / "run.mcap")
    assert list((tmp_path / "out").iterdir()) == []
