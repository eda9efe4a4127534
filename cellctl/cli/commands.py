"""Every command of `cellctl`."""

from cellctl.cli import check, demo, faults, replay, run, runs
from cellctl.cli.offline import calibrate, identify_payload, measure
from cellctl.cli.operator.commands import add_operator_commands
from cellctl.cli.root import new_app

_CELL, _RECORDS, _OFFLINE = "The cell", "Records and faults", "From files, without a cell"

app = new_app()
app.command("check", rich_help_panel=_CELL)(check.check)
app.command("run", rich_help_panel=_CELL)(run.run)
app.command("demo", rich_help_panel=_CELL, context_settings=demo.PASS_THROUGH)(demo.demo)
add_operator_commands(app)
app.add_typer(runs.app, name="runs", rich_help_panel=_RECORDS)
app.command("replay", rich_help_panel=_RECORDS)(replay.replay)
app.command("faults", rich_help_panel=_RECORDS)(faults.faults)
app.add_typer(calibrate.app, name="calibrate", rich_help_panel=_OFFLINE)
app.command("measure", rich_help_panel=_OFFLINE)(measure.measure)
app.command("identify-payload", rich_help_panel=_OFFLINE)(identify_payload.identify_payload)
