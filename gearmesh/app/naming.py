"""Refusals as the command line names things: the one place that takes an argument of a call to the option of a command."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, get_type_hints

from typer.models import OptionInfo

from gearmesh.errors import GearmeshError

#: what parameters of commands are called in the calls that they are handed on to, where that differs
CALLED = {"tolerance": "tol", "overrides": "settings", "folder": "output", "path": "output", "moved": "move"}


def naming_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """A command whose refusals of arguments name its options."""

    @functools.wraps(command)
    def run(*arguments: Any, **options: Any) -> Any:
        try:
            return command(*arguments, **options)
        except GearmeshError as failure:
            if not failure.of_argument:
                raise
            raise failure.rename(option_of(command, failure.key)) from failure

    return run


def option_of(command: Callable[..., Any], argument: str) -> str:
    """What a command calls an argument: its option, "--tol" of tolerance; the argument itself where it has none."""
    options = _options(command)
    named = f"--{argument.replace('_', '-')}"
    if named in options.values():
        return named
    return options.get(argument) or options.get(CALLED.get(argument, argument)) or argument


def _options(command: Callable[..., Any]) -> dict[str, str]:
    """The options of a command by its parameters."""
    options = {}
    for name, hint in get_type_hints(command, include_extras=True).items():
        (about,) = getattr(hint, "__metadata__", (None,))
        if isinstance(about, OptionInfo):
            # of an annotation typer takes the first name for the default
            names = [about.default, *(about.param_decls or ())]
            given = [name for name in names if isinstance(name, str) and name.startswith("--")]
            options[name] = given[0] if given else f"--{name.replace('_', '-')}"
    return options
