"""Mistakes between arms: zones that keep nothing apart, loads and sensors of another arm."""

from pathlib import Path

from tests.unit.config.mistake import Mistake, deck, deck_elsewhere

_TEXT = (Path(__file__).parents[3] / "config" / "deck.toml").read_text()
_FIRST = _TEXT[_TEXT.index("[zones.beside_head_1]") : _TEXT.index("[zones.beside_head_2]")]
_BOTH = _TEXT[_TEXT.index("[zones.beside_head_1]") : _TEXT.index("[processes.deck-to-frame]")]
_LOAD = _TEXT[_TEXT.index("[robots.main.load]") : _TEXT.index("[robots.main.settings]")]
_EXCHANGED = _BOTH.replace("aux_1", "?").replace("aux_2", "aux_1").replace("?", "aux_2")
_MAIN_1, _MAIN_2 = "zones.beside_head_1.robots.main", "zones.beside_head_2.robots.main"
_ORDER = 'retreat = ["main", "aux_1"]'
_SENSOR = "flange_T_sensor = [0.0, 0.0, 60.0, 0.0, 0.0, 0.0]"

BETWEEN_ARMS = (
    deck_elsewhere(_FIRST, "", "robots.aux_1", "a zone that names both"),
    deck_elsewhere(_BOTH, "", "robots.aux_2", "a zone that names both"),
    deck_elsewhere(
        _FIRST, _FIRST.replace("aux_1", "aux_2"), "robots.aux_1", "a zone that names both"
    ),
    deck(_BOTH, _EXCHANGED, _MAIN_1, "or the zone is for another arm"),
    deck("[2700.0, -300.0, 2600.0]", "[2700.0, -600.0, 2600.0]", _MAIN_1, "y -5"),
    deck("[2700.0, -300.0, 2600.0]", "[2700.0, -300.0, 1600.0]", _MAIN_1, "the way home"),
    deck("[800.0, 60.0, 300.0]", "[800.0, 600.0, 300.0]", _MAIN_2, "a box that holds x"),
    deck(
        "aux_1 = { min_mm = [1450.0, -800.0, 600.0]",
        "aux_1 = { min_mm = [1450.0, -800.0, 1060.0]",
        "zones.beside_head_1.robots.aux_1",
        "holds its pose measuring",
    ),
    deck(
        "aux_1 = { min_mm = [1450.0, -800.0, 600.0]",
        "aux_1 = { min_mm = [1850.0, -800.0, 600.0]",
        "zones.beside_head_1.robots.aux_1",
        "with 100 mm more on every side",
    ),
    deck(_ORDER, 'retreat = ["aux_1", "main"]', "zones.beside_head_1.retreat", "main before aux_1"),
    deck(_ORDER, 'retreat = ["aux_1"]', "zones.beside_head_1.retreat", "for a head that stays"),
    deck_elsewhere(
        "[2700.0, -300.0, 2600.0]",
        "[2700.0, 100.0, 2600.0]",
        "robots.main.poses_deg.home",
        "rests at this pose while others work, and would keep aux_1 out",
    ),
    deck_elsewhere(
        "aux_1 = { min_mm = [1450.0",
        "aux_1 = { min_mm = [1250.0",
        "robots.aux_1.poses_deg.retracted",
        "and would keep main out of the zone for good (F314)",
    ),
    *(
        deck(
            'way_out = "+y"',
            f'way_out = "{side}"',
            f"{_MAIN_1}.way_out",
            "'+y', where its taught pose home lies outside",
        )
        for side in ("-x", "+x", "+z", "-z")
    ),
    *(
        deck(
            'way_out = "-x"',
            f'way_out = "{side}"',
            "zones.beside_head_1.robots.aux_1.way_out",
            "'-x', where its taught pose retracted",
        )
        for side in ("-y", "+y", "+z", "-z")
    ),
    deck(
        _LOAD, _LOAD.replace("main", "aux_1"), "robots.aux_1.load", "did you mean robots.main.load?"
    ),
    *(
        deck_elsewhere(
            "com_mm = [30.0, 20.0,",
            f"com_mm = [{place}",
            "force_sensors.force.flange_T_sensor",
            "so the stored payload has the centre of mass where the load has it",
        )
        for place in ("-30.0, 20.0,", "30.0, -20.0,")
    ),
    *(
        deck(
            _SENSOR,
            _SENSOR.replace("60.0, 0.0", f"60.0, {turn}"),
            "force_sensors.force.flange_T_sensor",
            f"[0.0, 0.0, 60.0, {back}, 0.0, 0.0], turned about its z axis",
        )
        for turn, back in (("90.0", "0.0"), ("-90.0", "0.0"), ("180.0", "0.0"))
    ),
)

UNLIKE_BOX = deck(
    "aux_2 = { min_mm = [1450.0",
    "aux_2 = { min_mm = [1750.0",
    "zones.beside_head_2.robots.aux_2",
    "differs by 300 mm from zones.beside_head_1.robots.aux_1",
)
"""A remark: other things may stand around the other arm."""

LOW_BOX = Mistake(
    "cell.toml",
    "workspace_min_mm = [900.0, -900.0, 880.0]",
    "workspace_min_mm = [900.0, -900.0, 88.0]",
    "robots.main.settings.workspace_min_mm",
    "414 mm below the plane on which the arm stands",
)
"""A remark: the arm may stand on a pedestal."""
