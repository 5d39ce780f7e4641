"""Bounds as printed in free text: rounded so that they are never beyond the allowed value; see `gearmesh.allowed`."""

from gearmesh.allowed import rounded_down as at_most
from gearmesh.allowed import rounded_up as at_least

__all__ = ["at_least", "at_most"]
