"""Inspection of a gear: evaluated measurements, with the tolerance classes that the gear meets."""
