"""Answers about contact under load."""
