"""Answers that are bodies: solids, CAD, sections, finite-element models."""
