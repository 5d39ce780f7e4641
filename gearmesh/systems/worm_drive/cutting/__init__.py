"""Cutting of the wheel: feed of its hob, and the face over which it has flanks."""
