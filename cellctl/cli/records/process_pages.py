"""The pages that the process of a run adds to its report."""

from cellctl.config.process_definition import installed_processes, process_definition
from cellctl.records.report.sections import ReportBuilder, no_pages
from cellctl.runtime.process import Process


def pages_of(process: str) -> ReportBuilder:
    """The builder of a process's pages; that of the general pages when it is not installed.

    Records outlive software: a run must be exported years after its process was last installed.
    Raises ``UnknownDriver`` when the process is installed and cannot be loaded.
    """
    if process not in installed_processes():
        return no_pages
    definition = process_definition(process)
    return definition.report if issubclass(definition, Process) else no_pages
