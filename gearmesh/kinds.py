"""Parts of a gear system of your own: designs, motions, surfaces, teeth, bodies and members, from one module.

    from gearmesh.kinds import CradleRoll, Envelope, PairDesign, ToothSide

`kinds.pyi` lists the names; each is loaded when it is first used. The guide "Add a gear system of your own" and the page
"Any tool, any motion" say what they are for. These names are public: they change as those of `gearmesh` do.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import lazy_loader

_loaded_name, _, __all__ = lazy_loader.attach_stub("gearmesh", __file__)


class _Kinds(ModuleType):
    """This module, which takes the place of the function `gearmesh.kinds` once it is imported, and can be called like it."""

    def __call__(self) -> tuple[str, ...]:
        """Return all kinds of designs; see `gearmesh.systems.system.kinds`."""
        from gearmesh.systems.system import kinds

        return kinds()


def __getattr__(name: str) -> Any:
    """Return a name of the stub."""
    package = vars(sys.modules["gearmesh"])
    known = name in package
    value = globals()[name] = _loaded_name(name)
    if not known:
        # the loader keeps what it finds in the package, whose public names are others
        package.pop(name, None)
    return value


def __dir__() -> list[str]:
    return __all__


sys.modules[__name__].__class__ = _Kinds
