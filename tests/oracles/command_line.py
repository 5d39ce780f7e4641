"""The program run in this process."""

from __future__ import annotations

import io
import re
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from gearmesh.app import cli


def run(*arguments: str | Path) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of the program, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = cli.main([str(argument) for argument in arguments])
    return status, out.getvalue(), err.getvalue()


#: what is in work, a line each, before anything is said of it
STAGE = re.compile(r"^gearmesh: (?!warning|error).*\n", re.MULTILINE)


def messages(err: str) -> str:
    """Warnings and errors of standard error, without the stages of the work."""
    return STAGE.sub("", err)


def refused(*arguments: str | Path, status: int = 2) -> str:
    """The error message of a run that must fail with one line and print nothing else."""
    found, out, err = run(*arguments)
    assert (found, out) == (status, "")
    err = messages(err)
    assert err.startswith("gearmesh: error: ")
    assert len(err.splitlines()) == 1
    return err.removeprefix("gearmesh: error: ").rstrip("\n")
