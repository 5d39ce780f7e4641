"""Names of options in refusals: the translation from arguments of calls to options of commands."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, get_args, get_type_hints

from typer.models import OptionInfo

from gearmesh.errors import ArgumentError, GearmeshError
from gearmesh.numerals import parse_number, parse_whole_number, with_letters, with_point

#: units of options, by the names of their values in the usage
OPTION_UNITS = {"NM": "Nm", "RPM": "1/min", "DEG": "deg", "MMPM": "mm/min", "UM": "um", "P": "1/inch"}
#: parameters of commands, by the arguments of calls with other names
CALL_NAMES = {"tolerance": "tol", "overrides": "settings", "folder": "output", "path": "output", "moved": "move"}


def naming_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Return a command whose refusals of arguments name its options."""

    @functools.wraps(command)
    def run(*arguments: Any, **options: Any) -> Any:
        try:
            return command(*arguments, **options)
        except GearmeshError as failure:
            if not failure.of_argument:
                raise
            raise failure.rename(option_of(command, failure.key)) from failure

    hints, own = number_options(command), inspect.signature(command)
    parameters = [one.replace(annotation=hints[name]) for name, one in own.parameters.items()]
    # typer reads the annotations of the function and of its signature
    run.__annotations__, vars(run)["__signature__"] = hints, own.replace(parameters=parameters)
    return run


def number_options(command: Callable[..., Any]) -> dict[str, Any]:
    """Return the annotations of a command, with this program's parsers for options that are numbers.

    The parsers refuse a text that is no number, with its value and in the same words for every version of typer.
    """
    names, hints = _options(command), get_type_hints(command, include_extras=True)
    for parameter, hint in hints.items():
        (about,) = getattr(hint, "__metadata__", (None,))
        if isinstance(about, OptionInfo) and about.parser is None:
            own = get_args(hint)[0]
            kinds = {kind for kind in (get_args(own) or (own,)) if kind is not type(None)}
            if kinds <= {int, float}:
                unit = OPTION_UNITS.get(str(about.metavar), "")
                about.parser = _reader(names[parameter], int if kinds == {int} else float, about.min, about.max, unit)
    return hints


def _reader(
    option: str, kind: type[int] | type[float], low: float | None, high: float | None, unit: str
) -> Callable[[Any], float]:
    """Return a parser of the number in the text of an option, which raises ArgumentError."""
    bounds = [f"{word} {bound:g}" for word, bound in (("from", low), ("up to", high)) if bound is not None]
    must_be = " ".join(("a whole number" if kind is int else "a number", *bounds))
    bare = f"{must_be.replace('a ', 'a bare ', 1)}{unit and f' in {unit}'}, without letters behind it"

    def read(text: Any) -> float:
        # a default is a number already
        value = (parse_whole_number if kind is int else parse_number)(text) if isinstance(text, str) else text
        if value is None:
            raise ArgumentError(option, text, must_be=bare if with_letters(text) else must_be, remedy=with_point(text))
        if (low is not None and not value >= low) or (high is not None and not value <= high):
            raise ArgumentError(option, text, must_be=must_be)
        return value

    # the usage shows the name of the parser as the name of the value
    read.__name__ = "INTEGER" if kind is int else "FLOAT"
    return read


def option_of(command: Callable[..., Any], argument: str) -> str:
    """Return the option of a command for an argument, as "--tol" for tolerance, or the argument if there is no option."""
    options = _options(command)
    named = f"--{argument.replace('_', '-')}"
    if named in options.values():
        return named
    return options.get(argument) or options.get(CALL_NAMES.get(argument, argument)) or argument


def _options(command: Callable[..., Any]) -> dict[str, str]:
    """Return the options of a command, by its parameters."""
    options = {}
    for name, hint in get_type_hints(command, include_extras=True).items():
        (about,) = getattr(hint, "__metadata__", (None,))
        if isinstance(about, OptionInfo):
            # typer stores the first name of an annotation as its default
            names = [about.default, *(about.param_decls or ())]
            given = [name for name in names if isinstance(name, str) and name.startswith("--")]
            options[name] = given[0] if given else f"--{name.replace('_', '-')}"
    return options
