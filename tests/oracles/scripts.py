"""Modules of scripts/, which is no package."""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType

from oracles.places import ROOT


def script(name: str) -> ModuleType:
    """The module scripts/NAME.py; scripts that import each other find each other."""
    folder = ROOT / "scripts"
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    spec = importlib.util.spec_from_file_location(f"scripts_{name}", folder / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module
