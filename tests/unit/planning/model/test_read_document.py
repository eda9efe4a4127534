"""The keys of a model file, as `cellctl check` tells what is wrong with them."""

from pathlib import Path

from cellctl.planning.model.read_document import document_issues, read_document
from tests.unit.planning.deck_cell import write_model


def test_a_good_model_has_nothing_wrong(tmp_path: Path) -> None:
    model = write_model(tmp_path, "", "")
    assert document_issues(model) == []
    assert "main" in read_document(model).robots


def test_each_wrong_key_has_its_file_and_line_and_the_nearest_key(tmp_path: Path) -> None:
    model = write_model(tmp_path, "margin_mm = 20.0", "margins_mm = 20.0")
    text = model.read_text(encoding="utf-8")
    wrong = text[: text.index("margins_mm")].count("\n") + 1
    found = document_issues(model)
    (unknown,) = (one for one in found if one.key.endswith("margins_mm"))
    assert unknown.key == f"{model.name}, line {wrong}: robots.main.margins_mm"
    assert "margin_mm" in unknown.allowed
    assert all(one.line is None and one.number == 102 for one in found)


def test_a_syntax_error_has_its_place(tmp_path: Path) -> None:
    model = write_model(tmp_path, "[robots.main]", "[robots.main")
    (found,) = document_issues(model)
    assert (found.number, found.key) == (101, model.name)
    assert "(at line " in found.allowed
