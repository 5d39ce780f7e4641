"""Teeth from their surfaces, trimmed; members, their mounting, and which of them mesh."""
