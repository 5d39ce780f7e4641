"""Inspection of teeth: evaluation of measured deviations, tolerances, accuracy classes, and corrections of machine
settings."""
