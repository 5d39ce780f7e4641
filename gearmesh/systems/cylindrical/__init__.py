"""Spur and helical gears on parallel axes, external and internal, pairs and one alone [ISO 21771]."""
