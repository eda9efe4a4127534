"""Loads of arms against their own tolerances and the force sensor that carries them."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.devices import LoadConfig
from cellctl.config.driver_settings import measuring_range
from cellctl.config.issue import ConfigIssue

G_M_S2 = 9.81
_MOST_TOLERANCE = 0.25
"""Largest tolerance over the mass: a controller that reckons with a quarter more or less moves
another arm."""
_MOST_NOT_WEIGHED = 0.5
_LEAST_TOLERANCE_MM = 0.5


def load_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Tolerances that let any load pass, loads in the arm, weights beyond the sensor's range."""
    for name, robot in cell.robots.items():
        if robot.load is not None:
            yield from _tolerances(f"robots.{name}.load", robot.load)
            yield from _behind(f"robots.{name}.load.com_mm", robot.load)
            yield from _weight(cell, name, robot.load)
            yield from _straight(cell, name, robot.load)
    yield from _on_another_arm(cell)


def _on_another_arm(cell: CellConfig) -> Iterator[ConfigIssue]:
    """A load of an arm without a force sensor, where the arm that has one has none.

    The load that is weighed is compared with that of the arm which carries the sensor. Written for
    another arm it would be compared with nothing, and that arm would be told a load that it lacks.
    """
    weighing = {sensor.mounted_on: name for name, sensor in cell.force_sensors.items()}
    without = [robot for robot in weighing if robot in cell.robots and not cell.robots[robot].load]
    for name, robot in cell.robots.items():
        if without and robot.load is not None and name not in weighing:
            meant = without[0]
            allowed = (
                f"did you mean robots.{meant}.load? force_sensors.{weighing[meant]} weighs what "
                f"{meant} carries, and no load is stated there; state both where both carry one"
            )
            yield ConfigIssue(f"robots.{name}.load", f"{robot.load.mass_kg:g} kg", allowed)


def _tolerances(path: str, load: LoadConfig) -> Iterator[ConfigIssue]:
    most_kg = _MOST_TOLERANCE * load.mass_kg
    if load.tolerance_kg > most_kg:
        allowed = (
            f"at least {load.tolerance_kg / _MOST_TOLERANCE:g} with tolerance_kg = "
            f"{load.tolerance_kg:g}, or a tolerance of at most {most_kg:g}: a quarter of the mass"
        )
        yield ConfigIssue(f"{path}.mass_kg", f"{load.mass_kg:g}", allowed)
    if load.not_weighed_kg > _MOST_NOT_WEIGHED * load.mass_kg:
        allowed = (
            f"at most {_MOST_NOT_WEIGHED * load.mass_kg:g}, half of mass_kg: the sensor's own body "
            "and what is between it and the flange"
        )
        yield ConfigIssue(f"{path}.not_weighed_kg", f"{load.not_weighed_kg:g}", allowed)
    most_mm = max(abs(one) for one in load.com_mm) / 2.0
    if load.tolerance_mm > most_mm:
        allowed = f"at most {most_mm:g}, half of the way from the flange to com_mm"
        yield ConfigIssue(f"{path}.tolerance_mm", f"{load.tolerance_mm:g}", allowed)
    elif load.tolerance_mm < _LEAST_TOLERANCE_MM:
        allowed = f"at least {_LEAST_TOLERANCE_MM:g} mm; no weighing is so exact, was it in metres?"
        yield ConfigIssue(f"{path}.tolerance_mm", f"{load.tolerance_mm:g}", allowed)


def _behind(key: str, load: LoadConfig) -> Iterator[ConfigIssue]:
    if load.com_mm[2] < 0.0:
        allowed = "before the flange, whose z points away from the arm: z of at least 0"
        yield ConfigIssue(key, str(list(load.com_mm)), allowed)


def _straight(cell: CellConfig, robot: str, load: LoadConfig) -> Iterator[ConfigIssue]:
    """A free motion whose own acceleration trips the guard."""
    acceleration_m_s2 = cell.robots[robot].linear_acceleration_mm_s2 / 1e3
    least_n = (load.mass_kg - load.not_weighed_kg) * acceleration_m_s2
    for name, sensor in cell.force_sensors.items():
        if sensor.mounted_on == robot and sensor.free_force_n < least_n:
            allowed = (
                f"at least {least_n:.0f}: so much {load.mass_kg:g} kg take in straight "
                f"moves by linear_acceleration_mm_s2 of robots.{robot}; joint moves take more"
            )
            where = f"force_sensors.{name}.free_force_n"
            yield ConfigIssue(where, f"{sensor.free_force_n:g}", allowed)


def _weight(cell: CellConfig, robot: str, load: LoadConfig) -> Iterator[ConfigIssue]:
    weighed_n = (load.mass_kg - load.not_weighed_kg) * G_M_S2
    for name, sensor in cell.force_sensors.items():
        measuring = measuring_range(sensor)
        if sensor.mounted_on != robot or not measuring:
            continue
        most_n = min(measuring[:3])
        if weighed_n > most_n:
            allowed = (
                f"at most {most_n / G_M_S2:.0f} kg on force_sensors.{name}, whose range of "
                f"{most_n:g} N the weight of {weighed_n:.0f} N exceeds"
            )
            yield ConfigIssue(f"robots.{robot}.load.mass_kg", f"{load.mass_kg:g}", allowed)
