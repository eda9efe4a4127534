"""The house rules that a machine can check (docs/contributing.md)."""

import ast
import statistics
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import grimp
import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from cellctl.cli.faults import Language, catalogue_page
from cellctl.errors import CellError
from cellctl.fault_catalogue import shipped_faults

ROOT = Path(__file__).parent.parent
PACKAGES = ("cellctl", "drivers", "fakes")
SOURCES = sorted(path for name in PACKAGES for path in (ROOT / name).rglob("*.py"))
BLOCKS = {
    "config": 1,
    "link": 2,
    "robot": 3,
    "gripper": 3,
    "digital_io": 3,
    "vision": 4,
    "force": 5,
    "calibration": 6,
    "line": 7,
}
OUTSIDE_ITS_BLOCK = {564}
"""Numbers that were given before their fault came to the file where it belongs; they stay."""
DRIVER_FILES = {"README.md", "config.py", "protocol.py", "connection.py", "driver.py", "faults.py"}


FOR_DRIVERS = {"interfaces", "geometry", "errors", "clock"}
"""What of cellctl a driver may import."""


@cache
def parsed(path: Path) -> ast.Module:
    """Read once: most rules look through all files, and nobody changes a tree."""
    return ast.parse(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module", autouse=True)
def let_go() -> Iterator[None]:
    """All trees are millions of objects, which garbage collection would look through ever after."""
    yield
    parsed.cache_clear()


def lines(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def test_files_stay_small() -> None:
    sizes = {path: lines(path) for path in SOURCES}
    written = [size for size in sizes.values() if size > 2]
    assert statistics.median(written) < 100
    assert [str(path) for path, size in sizes.items() if size > 300] == []


def test_folders_can_be_read_at_a_glance() -> None:
    folders = Counter(path.parent for path in SOURCES)
    assert {str(folder): files for folder, files in folders.items() if files > 16} == {}


def test_every_module_says_what_it_is() -> None:
    silent = [
        str(path.relative_to(ROOT))
        for path in SOURCES
        if (tree := parsed(path)).body and not ast.get_docstring(tree)
    ]
    assert silent == []


def test_no_two_classes_have_one_name() -> None:
    # Fakes are left out: they read the same manuals independently, and so use the same words.
    places: dict[str, list[str]] = {}
    for path in (path for path in SOURCES if path.relative_to(ROOT).parts[0] != "fakes"):
        for node in parsed(path).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places.setdefault(node.name, []).append(str(path.relative_to(ROOT)))
    assert {name: paths for name, paths in places.items() if len(paths) > 1} == {}


def test_fault_numbers_are_unique_and_in_their_block() -> None:
    faults = shipped_faults()
    numbers = [fault.number for fault in faults]
    assert len(set(numbers)) == len(numbers)
    for fault in faults:
        block = BLOCKS.get(fault.__module__.rsplit(".", 1)[-1])
        in_block = fault.number // 100 == block or fault.number in OUTSIDE_ITS_BLOCK
        assert block is None or in_block, fault


def test_every_fault_tells_the_operator_what_to_do() -> None:
    for fault in shipped_faults():
        assert fault.text, fault
        assert fault.cause, fault
        assert fault.remedy, fault
        assert issubclass(fault, CellError)


def test_the_fault_catalogue_is_current() -> None:
    for page, language in (("faults.md", Language.ENGLISH), ("faults.zh.md", Language.CHINESE)):
        written = (ROOT / "docs" / page).read_text(encoding="utf-8")
        command = f"run `cellctl faults --lang {language} > docs/{page}`"
        assert written == catalogue_page(shipped_faults(), language), command


def driver_folders() -> list[Path]:
    return sorted(path.parent for path in (ROOT / "drivers").glob("*/*/driver.py"))


@pytest.mark.parametrize("folder", driver_folders(), ids=lambda path: path.name)
def test_driver_folders_hold_the_same_files(folder: Path) -> None:
    missing = DRIVER_FILES - {path.name for path in folder.iterdir()}
    assert not missing


@pytest.mark.parametrize("folder", driver_folders(), ids=lambda path: path.name)
def test_driver_protocols_do_no_io(folder: Path) -> None:
    tree = parsed(folder / "protocol.py")
    imported = {
        name.name.split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for name in node.names
    } | {
        (node.module or "").split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
    }
    assert not imported & {"asyncio", "socket", "serial", "can", "select", "threading"}


def test_import_contracts_name_every_package_of_the_core() -> None:
    core = {path.stem for path in (ROOT / "cellctl").iterdir() if path.suffix in {"", ".py"}}
    core -= {"__init__", "__pycache__"}
    document = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = {one["name"]: one for one in document["tool"]["importlinter"]["contracts"]}
    knows_no_process = contracts["the core knows no process"]["source_modules"]
    assert set(knows_no_process) == {f"cellctl.{name}" for name in core - {"processes"}}
    hidden = contracts["drivers see only interfaces, geometry, errors and the clock"]
    assert set(hidden["forbidden_modules"]) == {
        "fakes",
        *(f"cellctl.{name}" for name in core - FOR_DRIVERS),
    }


def imported(path: Path) -> set[str]:
    """Modules and names that a file imports, as dotted names."""
    found: set[str] = set()
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"{node.module}.{name.name}" for name in node.names}
    return found


def importing(folder: str, unwanted: str, *, but: str = "-") -> list[str]:
    """Files in the folder that import what they should not."""
    return [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / folder).rglob("*.py"))
        if not str(path.relative_to(ROOT)).startswith(but)
        and any(
            f"{name}.".startswith(unwanted) and not name.startswith("tests.rigs")
            for name in imported(path)
        )
    ]


def test_no_module_of_the_product_comes_back_to_itself() -> None:
    """Imports within functions count as well: a circle is no better for being closed late."""
    graph = grimp.build_graph("cellctl", "drivers", "fakes")
    modules = sorted(graph.modules)
    place = {module: at for at, module in enumerate(modules)}
    imports = [
        (place[module], place[imported])
        for module in modules
        for imported in graph.find_modules_directly_imported_by(module)
    ]
    rows, columns = np.transpose(imports)
    matrix = csr_array((np.ones(len(rows)), (rows, columns)), shape=(len(modules),) * 2)
    _, circles = connected_components(matrix, connection="strong")
    in_circles = np.bincount(circles)[circles] > 1
    assert [module for module, closed in zip(modules, in_circles, strict=True) if closed] == []


def test_tests_and_benchmarks_share_rigs_alone() -> None:
    assert importing("benchmarks", "tests.") == []
    assert importing("tests/rigs", "tests.") == []
    assert importing("tests", "benchmarks.", but="tests/unit/benchmarks") == []


def mirrored(test: Path) -> Path:
    """The folder of the code that a unit test is about."""
    inside = test.parent.relative_to(ROOT / "tests" / "unit")
    of_the_core = not inside.parts or inside.parts[0] not in {"drivers", "fakes", "benchmarks"}
    return ROOT / "cellctl" / inside if of_the_core else ROOT / inside


def test_unit_tests_mirror_the_tree() -> None:
    tests = sorted((ROOT / "tests" / "unit").rglob("test_*.py"))
    nowhere = [str(test) for test in tests if not mirrored(test).is_dir()]
    assert nowhere == []
    too_high = {
        str(test.relative_to(ROOT)): [str(module.relative_to(ROOT)) for module in deeper]
        for test in tests
        if not (mirrored(test) / (name := test.name.removeprefix("test_"))).exists()
        and not (mirrored(test) / name.removesuffix(".py")).is_dir()
        and (deeper := sorted(mirrored(test).rglob(name)))
    }
    assert too_high == {}


UNITS = ("S", "N", "M", "MM", "DEG", "RAD", "HZ", "BYTES", "PX")


def test_tests_set_times_and_limits_by_arguments() -> None:
    # A test that swaps a constant or the clock of a module goes on passing when the code reads
    # the figure from somewhere else, and says nothing of who else reads it.
    swapped = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in sorted((ROOT / "tests").rglob("*.py"))
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "setattr"
        for name in [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
        if isinstance(name, str)
        and ((last := name.rpartition(".")[2]) == "now_s" or _is_figure(last))
    ]
    assert swapped == []


def _is_figure(name: str) -> bool:
    """A constant that carries its unit, as in ``TIMEOUT_S``."""
    return name.isupper() and name.rpartition("_")[2] in UNITS
