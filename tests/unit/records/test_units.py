"""Every key that a process or procedure writes has its unit at its end, and pages show it right."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import cellctl
from cellctl.records.report.text import facts
from cellctl.records.units import KNOWN_UNITS, SIX_MM_DEG, WRITTEN_POSES, label, without_unit

SOURCE = Path(cellctl.__file__).parent
WRITERS = (
    "calibration", "cell", "force", "geometry", "interfaces", "procedures", "processes", "records",
    "runtime", "vision",
)  # fmt: skip
"""Packages in which that which is recorded is made."""
MOMENTS = frozenset(
    {
        "dead_band_n_m", "early_moment_n_m", "entry_moment_z_n_m", "fault_n_m", "hold_out_n_m",
        "limit_n_m", "max_moment_n_m", "max_untared_moment_n_m", "moment_n_m", "moment_z_n_m",
        "mx_n_m", "my_n_m", "mz_n_m", "peak_moment_n_m", "residual_n_m", "torque_offset_n_m",
    }
)  # fmt: skip
RISES = frozenset(
    {
        "contact_stiffness_n_m", "lateral_spring_n_m", "lateral_stiffness_n_m", "rim_spring_n_m",
        "seat_slope_n_m", "stiffness_n_m",
    }
)  # fmt: skip
"""Forces over a way: newtons per metre."""
PLAIN_ENDS = frozenset(
    {
        "1", "2", "at", "box", "by", "c", "det", "dip", "e", "eye", "for", "gap", "id",
        "ids", "in", "io", "ios", "key", "lay", "map", "ok", "on", "out", "peg", "png",
        "t", "top", "up", "way",
    }
)  # fmt: skip
"""Short words that end a key and are no unit."""
SPELT_OUT = frozenset(
    {
        "ampere", "bar", "celsius", "degree", "degrees", "kelvin", "metre", "metres",
        "millimetre", "minutes", "newton", "newtons", "pascal", "radian", "radians",
        "rpm", "second", "seconds", "volt", "volts",
    }
)  # fmt: skip
"""Units whose keys have a short form."""
OTHER_UNITS = frozenset({"", "%", "σ", "1", "Hz", "of 4"})
"""Beside those at the ends of keys, what a figure may be counted in."""


PLACE_OF_UNIT = {"figure": 2, "LimitCheck": 3}
"""Of those who take a figure, which argument says its unit."""


class Written(ast.NodeVisitor):
    """What is written in the packages of WRITERS."""

    def __init__(self) -> None:
        self.keys: set[str] = set()
        """Keys of mappings, and the fields of classes, which become keys where a record is made."""
        self.units: list[tuple[str, object]] = []
        """Units of figures, with their places."""
        for package in WRITERS:
            for path in sorted((SOURCE / package).rglob("*.py")):
                self._file = path.name
                self.visit(ast.parse(path.read_text(encoding="utf-8")))

    def visit_Dict(self, node: ast.Dict) -> None:
        for key in node.keys:
            # Of a key that is put together its end has the unit.
            last = key.values[-1] if isinstance(key, ast.JoinedStr) else key
            if isinstance(last, ast.Constant) and isinstance(last.value, str):
                self.keys.add(last.value)
        self.generic_visit(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for field in node.body:
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                self.keys.add(field.target.id)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        called = getattr(node.func, "attr", getattr(node.func, "id", ""))
        place = PLACE_OF_UNIT.get(called)
        if place is not None and len(node.args) > place:
            unit = node.args[place]
            if isinstance(unit, ast.Constant):
                self.units.append((f"{self._file}:{node.lineno}", unit.value))
        self.generic_visit(node)


@cache
def written() -> Written:
    """Read by the first test that asks: every worker collects this file, and few run it."""
    return Written()


UNITS_ALONE = frozenset({SIX_MM_DEG, "_n_m", "n_m", "n_mm"}) | WRITTEN_POSES
NOT_WRITTEN = frozenset({"sigma_n_m"})
"""Of a stiffness, which records have in N/mm."""


def keys() -> set[str]:
    found = {key for key in written().keys if re.fullmatch(r"[a-z0-9_]*_[a-z0-9]+", key)}
    return found - UNITS_ALONE - NOT_WRITTEN


def test_no_key_ends_in_what_the_pages_do_not_know() -> None:
    unknown = []
    for key in keys():
        name, unit = without_unit(key.removesuffix(SIX_MM_DEG))
        last = name.rsplit("_", 1)[-1]
        if unit:
            # What is left of ``stiffness_n_mm`` by a table without that unit is ``stiffness_n``.
            wrong = f"_{last}" != name and without_unit(f"a_{last}")[1] != ""
        else:
            wrong = (len(last) <= 3 and last not in PLAIN_ENDS) or last in SPELT_OUT
        if wrong:
            unknown.append(key)
    assert not unknown, "a unit for cellctl.records.units, or a plain word for PLAIN_ENDS"


def test_each_newton_metre_is_stated_to_be_a_moment_or_a_rise_of_force() -> None:
    found = {key for key in keys() if key.endswith("_n_m")}
    assert found == MOMENTS | RISES, "newtons times metres, or newtons per metre?"
    assert {key: without_unit(key)[1] for key in found} == {
        key: "N/m" if key in RISES else "N·m" for key in found
    }


def test_figures_and_checks_are_in_units_that_the_pages_know() -> None:
    units = written().units
    assert len(units) > 50
    assert [one for one in units if one[1] not in KNOWN_UNITS | OTHER_UNITS] == []


@pytest.mark.parametrize(
    ("key", "name", "unit"),
    [
        ("seat_slope_n_m", "seat slope", "N/m"),
        ("stiffness_n_mm", "stiffness", "N/mm"),
        ("yaw_stiffness_n_m_rad", "yaw stiffness", "N·m/rad"),
        ("moment_z_n_m", "moment z", "N·m"),
        ("residual_rms_nm", "residual rms", "N·m"),
        ("squareness_rad", "squareness", "rad"),
        ("temperature_deg_c", "temperature", "°C"),
    ],
)
def test_compound_units(key: str, name: str, unit: str) -> None:
    assert label(key) == (name, unit)


def test_pages_have_one_unit_for_each_quantity() -> None:
    in_record = {
        "depth_m": 0.01197, "seat_slope_n_m": 106871.0, "tilt_rad": 0.1, "touch_speed_m_s": 0.0014,
        "plays_m": [0.001, None], "steps_m": 2, "inserted": True,
    }  # fmt: skip
    assert list(facts(in_record)) == [
        ("depth", "11.97 mm"),
        ("seat slope", "106.9 N/mm"),
        ("tilt", "5.73°"),
        ("touch speed", "1.4 mm/s"),
        ("plays", "1, – mm"),
        ("steps", "2000 mm"),
        ("inserted", "yes"),
    ]
