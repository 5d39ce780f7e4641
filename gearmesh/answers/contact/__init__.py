"""Answers about contact without load."""
