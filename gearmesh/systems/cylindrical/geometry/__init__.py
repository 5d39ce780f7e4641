"""Cylindrical gears in closed form [ISO 21771]: dimensions, measures, tolerances."""
