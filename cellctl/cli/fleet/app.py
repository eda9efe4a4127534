"""`cellctl fleet` with its sub-commands."""

import typer

from cellctl.cli.fleet import administer, forward, search

app = typer.Typer(
    help="Records of many cells in one PostgreSQL: deliver, search, verify.", no_args_is_help=True
)
app.command("init")(administer.init)
app.command("add")(administer.add)
app.command("migrate")(administer.migrate)
app.command("forward")(forward.forward)
app.command("cells")(search.cells)
app.command("runs")(search.runs)
app.command("show")(search.show)
app.command("verify")(search.verify)
