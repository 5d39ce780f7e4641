"""Rack cutters: their tooth space, and members that they generate."""
