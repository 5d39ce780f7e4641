"""Blanks of bevel gears."""
