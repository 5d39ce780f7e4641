"""Teeth from their surfaces, trimmed; members, how they stand, and which of them mesh."""
