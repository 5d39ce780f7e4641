"""Spur and helical gears on parallel axes, external and internal: pairs and single gears [ISO 21771]."""
