"""Cylindrical stages of REXS models as pairs and planetary sets, and back."""

from gearmesh.systems.cylindrical.rexs.pair import PAIR

__all__ = ["PAIR"]
