"""Teeth in contact under load: compliance of both members, pressures, load sharing, loaded transmission error, root stress."""
