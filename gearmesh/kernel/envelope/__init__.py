"""Envelopes of one and two parameters, and their limiting lines."""
