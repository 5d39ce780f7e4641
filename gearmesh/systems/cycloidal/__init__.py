"""Cycloidal drives: a disc with lobes that rolls inside a ring of pins, or a disc with pins inside a lobed ring."""
