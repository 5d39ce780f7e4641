"""Straight bevel gears: octoids cut by straight edges on a crown gear, and spherical involutes."""
