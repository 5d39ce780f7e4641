"""Optional libraries."""

from __future__ import annotations

from importlib import import_module

from gearmesh.errors import OutputError


def require(module: str, need: str, extra: str) -> None:
    """Raise OutputError if a module cannot be loaded.

    The message has the `need`, for example "DXF needs ezdxf", and the `extra` of the package to install. If the module lacks a
    library of the system, the message names this library instead.
    """
    try:
        import_module(module)
    except ImportError as error:
        if ".so" in str(error):
            missing = str(error).split(":")[0]
            what = need.partition(" needs ")[0]
            reason = f"{what} needs the system library {missing}: apt-get install libgl1 libx11-6"
            raise OutputError(reason=reason) from None
        raise OutputError(reason=f'{need}: pip install "gearmesh[{extra}]"') from None
