"""The command line. Commands load their modules when they run, so that `--help` and `describe` answer at once.

Exit statuses: 0 done, 2 bad input or output, 3 no solution, 130 stopped by Ctrl-C, 143 stopped by SIGTERM. A failure is one line on
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
from gearmesh.app.options import option
from gearmesh.app.stopping import Stopping
from gearmesh.app.terminal import one_line
from gearmesh.errors import GearmeshError
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX

#: base class of all errors of the command line itself, whose module depends on the installed typer
_UsageError: Any = typer.BadParameter.__mro__[1]

#: folders of the modules of commands, in the order of the list of commands
COMMAND_FOLDERS = {
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
    "train": "contact",
    "correct": "outputs",
    "drawing": "outputs",
    "freecad": "outputs",
    "toolpath": "outputs",
    "settings": "designs",
    "vh": "contact",
    "gear": "designs",
    "size": "designs",
    "study": "contact",
    "optimize": "contact",
    "describe": "designs",
    "new": "designs",
    "explore": "designs",
    "prove": "designs",
    "pin": "designs",
    "convert": "designs",
    "formats": "designs",
    "sample": "designs",
}


#: words that are tried for commands, with the command that is meant
OTHER_NAMES = {
    "optimise": "optimize",
    "optimum": "optimize",
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
    "live": "explore",
    "serve": "explore",
    "contact": "tca",
    "dxf": "drawing",
    "samples": "sample",
    "sizing": "size",
    "measure": "evaluate",
    "gearbox": "train",
    "stages": "train",
    "vtk": "solid",
    "suffixes": "formats",
    "suffix": "formats",
}

#: exit status after Ctrl-C
INTERRUPTED_STATUS = 130
#: largest number of kept files that are named after Ctrl-C
MAX_NAMED_FILES = 8


def command_line(names: Iterable[str] = COMMAND_FOLDERS) -> typer.Typer:
    """Return the program with some commands, by their names; loads the modules of these commands."""
    app = typer.Typer(
        name="gearmesh",
        help="Exact gear tooth surfaces, their contact, and meshes proved against both.",
        add_completion=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_program)
    for name in names:
        module = import_module(f"gearmesh.app.commands.{COMMAND_FOLDERS[name]}.{name}")
        app.command()(naming_options(getattr(module, name)))
    return app


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; an expected failure is one line on standard error."""
    _stand_in_for_closed_streams()
    given = sys.argv[1:] if arguments is None else list(arguments)
    if given and given[0] not in COMMAND_FOLDERS and not given[0].startswith("-"):
        return _fail(_no_command(given[0]), 2)
    # load only the module of the wanted command
    names = [given[0]] if given and given[0] in COMMAND_FOLDERS else [*COMMAND_FOLDERS]
    stopping = Stopping()
    try:
        with stopping:
            status = _group(names).main(args=given, prog_name="gearmesh", standalone_mode=False)
            sys.stdout.flush()
        if status == INTERRUPTED_STATUS or stopping.asked:
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
    """Return the refusal of a first argument that is no command, with the probable command."""
    from pathlib import Path

    from gearmesh.errors import nearest

    if Path(name).suffix in (TOML_SUFFIX, JSON_SUFFIX) or Path(name).is_file():
        return f"{name} is a design file, no command: gearmesh run {name} does the main job (see gearmesh --help)"
    other = OTHER_NAMES.get(name.lower()) or nearest(name, COMMAND_FOLDERS)
    hint = f"; did you mean {other}?" if other else ""
    return f"No such command {name!r}{hint} (see gearmesh --help)"


def _interruption() -> str:
    """Return the message of an interrupted command with the files that it has written whole."""
    from pathlib import Path

    from gearmesh.io.atomic import written_whole

    kept = written_whole()
    if not kept:
        return "stopped: no file was written"
    names = ", ".join(path.name for path in kept[:MAX_NAMED_FILES]) + (
        f" and {len(kept) - MAX_NAMED_FILES} more" if len(kept) > MAX_NAMED_FILES else ""
    )
    folder = kept[0].parent
    # paths may be given ones or resolved ones: compare the folders that they resolve to
    in_one = len({os.path.realpath(path.parent) for path in kept}) == 1
    where = f" in {folder}" if folder != Path() and in_one else ""
    return f"stopped: kept{where}, each of them whole: {names}"


def _group(names: Iterable[str]) -> Any:
    """Return the program as a group of commands, also for a single command."""
    return typer.main.get_command(command_line(names))


class _ClosedOutput(io.TextIOBase):
    """Stand-in for a standard output that was closed before the program began; writing to it is reported as an error."""

    def write(self, text: str) -> int:
        raise OSError(errno.EBADF, os.strerror(errno.EBADF), "standard output")


def _stand_in_for_closed_streams() -> None:
    """Replace closed standard streams: Python has None for them, and the next opened file would take their file descriptors."""
    if sys.stdout is None:
        os.open(os.devnull, os.O_WRONLY)
        sys.stdout = _ClosedOutput()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  as long as the program


def _fail(message: str, status: int) -> int:
    print(f"gearmesh: error: {one_line(message)}", file=sys.stderr)
    return status


def _drop_output() -> None:
    """Redirect a standard output that is closed or full to nowhere: Python writes to it once more on exit."""
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
        bool, option("--version", "Show the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass
