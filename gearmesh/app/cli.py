"""The command line. Commands load what they need when they run, so that `--help` and `describe` answer at once.

Exit statuses: 0 done, 2 bad input or output, 3 no solution, 130 stopped by Ctrl-C, 143 by SIGTERM; failures are one line on
standard error.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import Annotated, Any

import typer

from gearmesh import __version__
from gearmesh.app.naming import naming_options
from gearmesh.app.stopping import Stopping
from gearmesh.app.terminal import one_line
from gearmesh.errors import GearmeshError

#: Parent of every complaint about the command line itself, wherever the installed typer keeps it.
_UsageError: Any = typer.BadParameter.__mro__[1]

#: modules of the commands, in the order in which they are listed
COMMANDS = {
    "run": "outputs",
    "report": "outputs",
    "tca": "contact",
    "load": "contact",
    "solid": "outputs",
    "render": "outputs",
    "check": "contact",
    "fe": "outputs",
    "limits": "contact",
    "topography": "outputs",
    "grid": "outputs",
    "evaluate": "outputs",
    "composite": "contact",
    "correct": "outputs",
    "drawing": "outputs",
    "freecad": "outputs",
    "toolpath": "outputs",
    "settings": "designs",
    "vh": "contact",
    "gear": "designs",
    "size": "designs",
    "study": "contact",
    "describe": "designs",
    "new": "designs",
    "pin": "designs",
    "convert": "designs",
    "sample": "designs",
}


#: what else commands are looked for under
OTHER_NAMES = {
    "sheet": "describe",
    "info": "describe",
    "kinds": "describe",
    "template": "new",
    "step": "solid",
    "stl": "solid",
    "mesh": "solid",
    "build": "solid",
    "export": "solid",
    "picture": "render",
    "plot": "render",
    "view": "render",
    "contact": "tca",
    "dxf": "drawing",
    "samples": "sample",
    "sizing": "size",
    "measure": "evaluate",
    "vtk": "solid",
}

#: exit status after Ctrl-C, and files that are named then
INTERRUPTED, NAMED = 130, 8


def command_line(names: Iterable[str] = COMMANDS) -> typer.Typer:
    """The program with the commands of some names, whose modules are loaded."""
    app = typer.Typer(
        name="gearmesh",
        help="Exact gear tooth surfaces, their contact, and meshes proved against both.",
        add_completion=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_program)
    for name in names:
        module = import_module(f"gearmesh.app.commands.{COMMANDS[name]}.{name}")
        app.command()(naming_options(getattr(module, name)))
    return app


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; expected failures become one line on standard error."""
    _stand_in_for_closed_streams()
    given = sys.argv[1:] if arguments is None else list(arguments)
    if given and given[0] not in COMMANDS and not given[0].startswith("-"):
        return _fail(_no_command(given[0]), 2)
    # of the one that is asked for alone the module is loaded
    names = [given[0]] if given and given[0] in COMMANDS else [*COMMANDS]
    stopping = Stopping()
    try:
        with stopping:
            status = _group(names).main(args=given, prog_name="gearmesh", standalone_mode=False)
            sys.stdout.flush()
        if status == INTERRUPTED or stopping.asked:
            return _fail(_interruption(), stopping.status)
    except GearmeshError as error:
        return _fail(str(error), error.exit_status)
    except _UsageError as error:
        where = error.ctx.command_path if error.ctx else "gearmesh"
        said = error.format_message().rstrip(".").replace("Value error, ", "")
        return _fail(f"{said} (see {where} --help)", 2)
    except (typer.Abort, KeyboardInterrupt):
        return _fail(_interruption(), stopping.status)
    except BrokenPipeError:
        _drop_output()
        return 1
    except OSError as error:
        _drop_output()
        return _fail(f"{error.filename or 'standard output'}: {error.strerror or error}", 2)
    except MemoryError:
        return _fail("out of memory: choose a larger --tol, fewer positions or a smaller picture", 2)
    return status if isinstance(status, int) else 0


def _no_command(name: str) -> str:
    """The refusal of a first argument that is no command, with the one that may be meant."""
    from pathlib import Path

    from gearmesh.errors import nearest

    if Path(name).suffix in (".toml", ".json") or Path(name).is_file():
        return f"{name} is a design file, no command: gearmesh run {name} does the main job (see gearmesh --help)"
    other = OTHER_NAMES.get(name.lower()) or nearest(name, COMMANDS)
    hint = f"; did you mean {other}?" if other else ""
    return f"No such command {name!r}{hint} (see gearmesh --help)"


def _interruption() -> str:
    """What of an interrupted command is kept: files are whole, or not there."""
    from pathlib import Path

    from gearmesh.io.atomic import written_whole

    kept = written_whole()
    if not kept:
        return "stopped: no file was written"
    names = ", ".join(path.name for path in kept[:NAMED]) + (
        f" and {len(kept) - NAMED} more" if len(kept) > NAMED else ""
    )
    folder = kept[0].parent
    # some paths are as they were given, others what these lead to
    in_one = len({os.path.realpath(path.parent) for path in kept}) == 1
    where = f" in {folder}" if folder != Path() and in_one else ""
    return f"stopped: kept{where}, each of them whole: {names}"


def _group(names: Iterable[str]) -> Any:
    """The program as a group of commands: even of a single one."""
    return typer.main.get_command(command_line(names))


class _ClosedOutput(io.TextIOBase):
    """Stands in for a standard output that was closed before the program began: what is written to it is lost, and reported."""

    def write(self, text: str) -> int:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF), "standard output")


def _stand_in_for_closed_streams() -> None:
    """With a stream closed Python has None for it, and the next file opened takes its place in the system."""
    if sys.stdout is None:
        os.open(os.devnull, os.O_WRONLY)
        sys.stdout = _ClosedOutput()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  as long as the program


def _fail(message: str, status: int) -> int:
    print(f"gearmesh: error: {one_line(message)}", file=sys.stderr)
    return status


def _drop_output() -> None:
    """Let nothing more be written to a standard output that is closed or full: Python tries once more on exit."""
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):  # not a file
        return
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"gearmesh {__version__}")
        raise typer.Exit


def _program(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    pass
