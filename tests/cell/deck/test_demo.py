"""One deck on its frame, as `make demo` does it: three processes, real protocols, one good part."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

import cv2
import pytest

from cellctl.records.run_mcap.export import export_mcap
from cellctl.records.run_mcap.images import ImageForm
from cellctl.records.run_mcap.layout import layout_for
from cellctl.records.store import RunStore
from cellctl.vision.picture import INSET_PX
from tests.rigs.whole_cell.own_cell import OwnCell, cellctl
from tests.rigs.wire.job_rig import JOBS
from tests.unit.records.run_mcap.layout_fit import misfits
from tests.unit.records.run_mcap.reading import read

pytestmark = pytest.mark.timeout(300)


def test_a_good_part_with_its_record(own: OwnCell) -> None:
    out = own.folder / "run"
    demo = own.demo(out)
    assert demo.end(240) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    assert demo.stderr == ""
    assert "seed 1: good" in demo.stdout

    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    _within_the_limits_of_the_mission(result)
    _record_is_complete(out, result)
    assert _drivers_of_the_heads(out) == {"gige"}, "images through a GenTL producer"
    _commands_find_the_run(out / "store")
    _recording_fits_its_layout(out)


@pytest.mark.long  # a whole job, of which the way of the images alone differs
def test_a_good_part_with_images_of_frame_servers(own: OwnCell) -> None:
    out = own.folder / "run"
    demo = own.demo(out, "--cameras", "frame-server")
    assert demo.end(280) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    _within_the_limits_of_the_mission(json.loads((out / "result.json").read_text("utf-8")))
    assert _drivers_of_the_heads(out) == {"frame-server"}


def _recording_fits_its_layout(out: Path) -> None:
    opened = RunStore(out / "store", create=False)
    try:
        found = export_mcap(opened, 1, out / "run.mcap", ImageForm.JPEG)
    finally:
        opened.close()
    layout = json.loads(layout_for(found.messages, found.frames))
    assert misfits(layout, read(found.path)) == []
    kinds = Counter(name.partition("!")[0] for name in layout["configById"])
    assert kinds["Image"] == 4
    assert kinds["Plot"] >= 3


def _drivers_of_the_heads(out: Path) -> set[str]:
    cell = json.loads((out / "report" / "cell.json").read_text(encoding="utf-8"))
    return {head["driver"] for head in cell["stereo_cameras"].values()}


@pytest.mark.long  # the wire tests run the same job files, one arm at a time
def test_a_good_part_with_the_shipped_jobs_on_all_three_arms(own: OwnCell) -> None:
    out = own.folder / "run"
    demo = own.demo(out, "--robots", "jobs")
    assert demo.end(280) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    _within_the_limits_of_the_mission(json.loads((out / "result.json").read_text("utf-8")))
    # Only the shipped jobs say this of themselves; the fake of the protocol's text is older.
    version = re.search(r"version (\d+\.\d+):", (JOBS / "SJLMAIN.job").read_text("ascii"))
    assert version is not None
    log = (out / "daemon.log").read_text("utf-8")
    for arm in ("SR500A", "T90A-1", "T90A-2"):
        assert f"{arm} STA: connected, job program {version[1]}" in log


def _within_the_limits_of_the_mission(result: dict[str, Any]) -> None:
    assert result["passed"]
    assert 1 <= result["iterations"] <= 10
    assert result["lateral_mm"] < 0.2
    assert result["rotation_deg"] < 0.01
    assert result["rotation_about_x_deg"] < 0.02
    assert abs(result["seat_gap_mm"]) < 0.1
    assert 35.0 <= result["hold_force_n"] <= 45.0
    assert 0.0 < result["final_true_n"] < 50.0
    assert max(result["peak_true_n"], result["peak_sensed_n"]) < 50.0
    assert all(5.8 <= gauge <= 6.0 for gauge in result["gauge_mm"].values())
    errors = result["measured_error_mm_deg"]
    assert max(map(abs, errors[:3])) <= 0.05
    assert abs(errors[3]) <= 0.012
    assert max(map(abs, errors[4:])) <= 0.005


def _record_is_complete(out: Path, result: dict[str, Any]) -> None:
    report = out / "report"
    record = json.loads((report / "run.json").read_text(encoding="utf-8"))
    assert record["result"] == "good"
    assert len(record["passes"]) == result["iterations"]
    page = (report / "report.html").read_text(encoding="utf-8")
    measured = ["frame", "deck", *(f"iteration-{i + 1}" for i in range(result["iterations"]))]
    wanted = {
        f"{what}-head-{head}-{side}.jpg"
        for what in measured
        for head in (1, 2)
        for side in ("left", "right")
    }
    assert wanted <= {picture.name for picture in report.glob("*.jpg")}
    for picture in report.glob("*.jpg"):
        image = cv2.imread(str(picture))
        assert image is not None
        assert image.shape[:2] == (2048 + INSET_PX, 2448), picture.name
        assert f'src="{picture.name}"' in page, f"{picture.name} is not in the report"
    captions = ("by iteration", "over time", "over travel", "plug gauge")
    drawings = re.findall(r"<figure>\s*<svg.*?</figure>", page, re.DOTALL)
    for caption in captions:
        assert any(caption in drawing for drawing in drawings), f"no drawing {caption!r}"


def _commands_find_the_run(store: Path) -> None:
    where = ("--data-dir", str(store))
    listed = cellctl("runs", "list", *where)
    assert listed.returncode == 0
    assert "SAT-0001" in listed.stdout
    assert "good" in listed.stdout
    shown = cellctl("runs", "show", "1", *where)
    assert shown.returncode == 0
    assert "pin hole P1" in shown.stdout
    verified = cellctl("runs", "verify", *where)
    assert verified.returncode == 0, verified.stdout
    opened = RunStore(store, create=False)
    try:
        head = opened.run(1).head
    finally:
        opened.close()
    assert head.ended is not None
    assert head.simulated
