"""Involute splines: shaft and hub on one axis, by designation or by keys."""
