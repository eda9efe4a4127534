"""Checks that need several sections of a cell file at once."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from pydantic import ValidationError

from cellctl.config.cell import CellConfig
from cellctl.config.checks.bounds.bound import at_least
from cellctl.config.checks.exposures import exposure_issues
from cellctl.config.checks.outputs import output_issues
from cellctl.config.driver_settings import (
    LEAST_RATE_HZ,
    least_stale_ms,
    robot_driver,
    sensor_rate_hz,
)
from cellctl.config.issue import ConfigIssue, WrittenValue
from cellctl.errors.config import MixedSimulation, UnknownDriver
from cellctl.spelling import nearest


def cross_issues(cell: CellConfig, found: Sequence[ConfigIssue]) -> list[ConfigIssue]:
    """Contradictions between sections; ``found`` is what is wrong with the sections themselves."""
    return [
        *_names(cell),
        *_recipe_ids(cell),
        *_carriers(cell),
        *output_issues(cell, found),
        *exposure_issues(cell),
        *_pace(cell, found),
        *_simulation(cell),
    ]


def _names(cell: CellConfig) -> Iterator[ConfigIssue]:
    """One name, one device: logs, records and recipes name devices without their section."""
    paths = [key for key in cell.devices() if key.count(".") == 1]
    times = Counter(key.split(".")[1] for key in paths)
    for key in paths:
        name = key.split(".")[1]
        if times[name] > 1:
            yield ConfigIssue(key, repr(name), "device names must differ, over all sections")


def _recipe_ids(cell: CellConfig) -> Iterator[ConfigIssue]:
    first: dict[int, int] = {}
    for index, recipe in enumerate(cell.recipes):
        other = first.setdefault(recipe.id, index)
        if other != index:
            name = cell.recipes[other].name
            allowed = f"recipe ids must differ; recipe '{name}' has {recipe.id} already"
            value = f"{recipe.id} of recipe '{recipe.name}'"
            against = (WrittenValue(f"recipes.{other}.id", f"{recipe.id} of recipe '{name}'"),)
            yield ConfigIssue(f"recipes.{index}.id", value, allowed, against=against)


def _carriers(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Robots that cameras and force sensors refer to."""
    robots = ", ".join(cell.robots) or "none"
    for section in ("cameras", "stereo_cameras"):
        for name, camera in cell.section(section).items():
            carrier = getattr(camera, "carried_by", None)
            if carrier is not None and carrier not in cell.robots:
                key = f"{section}.{name}.carried_by"
                allowed = f"{nearest(carrier, cell.robots)}a robot of this cell: {robots}"
                yield ConfigIssue(key, repr(carrier), allowed)
    for name, sensor in cell.force_sensors.items():
        if sensor.mounted_on not in cell.robots:
            key = f"force_sensors.{name}.mounted_on"
            allowed = f"{nearest(sensor.mounted_on, cell.robots)}a robot of this cell: {robots}"
            yield ConfigIssue(key, repr(sensor.mounted_on), allowed)
    mounted = Counter(sensor.mounted_on for sensor in cell.force_sensors.values())
    for name, sensor in cell.force_sensors.items():
        if mounted[sensor.mounted_on] > 1:
            # A robot has one channel for a guard, and a guard has one sensor (decision 0003).
            key = f"force_sensors.{name}.mounted_on"
            yield ConfigIssue(key, repr(sensor.mounted_on), "a robot carries one force sensor")


def unpermitted(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Real robots that only programs of their controllers would stop without this PC."""
    for name, robot in cell.robots.items():
        if robot.simulated or robot.permit is not None:
            continue
        try:
            driver, settings = robot_driver(robot)
        except (UnknownDriver, ValidationError):
            continue  # reported by itself
        if driver.needs_permit(settings):
            allowed = (
                "{ device, output }: a contact of this PC in the arm's permit loop, which stops it "
                "when a program of its controller has ended; drivers/robot/siasun/job/README.md, "
                "section 3"
            )
            yield ConfigIssue(f"robots.{name}.permit", "(missing)", allowed)


def _pace(cell: CellConfig, found: Sequence[ConfigIssue]) -> Iterator[ConfigIssue]:
    """A limit of silence below the pace of the sensor would trip the guard at every sample."""
    for name, sensor in cell.force_sensors.items():
        key = f"force_sensors.{name}"
        if any(issue.key.startswith((f"{key}.driver", f"{key}.settings")) for issue in found):
            continue  # its rate is not known
        # Two samples: the arrival of one sample jitters, so a limit of one would trip on an even
        # stream.
        least_ms, rate_hz = least_stale_ms(sensor), sensor_rate_hz(sensor)
        if sensor.stale_ms >= least_ms:
            continue
        stale = WrittenValue(f"{key}.stale_ms", f"{sensor.stale_ms:g}", allowed=at_least(least_ms))
        rate = WrittenValue(f"{key}.settings.rate_hz", f"{rate_hz:g}")
        if rate_hz < LEAST_RATE_HZ:
            # A longer silence would only make the guard blind.
            allowed = (
                f"at least {LEAST_RATE_HZ:g} samples a second, for the guard to stop in time; at "
                f"this rate two samples take {least_ms:g} ms, and stale_ms = {sensor.stale_ms:g}"
            )
            yield ConfigIssue(rate.key, rate.value, allowed)
            continue
        faster = replace(rate, allowed=at_least(2e3 / sensor.stale_ms))
        allowed = f"{stale.allowed}, two samples at the sensor's rate"
        yield ConfigIssue(stale.key, stale.value, allowed, against=(faster,))


def _simulation(cell: CellConfig) -> Iterator[ConfigIssue]:
    devices = {key: device for key, (_, device) in cell.devices().items()}
    # A cell of real and simulated devices would move a real arm by what a picture of another world
    # shows.
    if len({device.simulated for device in devices.values()}) > 1:
        named = [key for key, device in devices.items() if device.simulated]
        text = f"{MixedSimulation.text}; mark all or none"
        yield ConfigIssue("simulated", ", ".join(named), text, MixedSimulation.number)
