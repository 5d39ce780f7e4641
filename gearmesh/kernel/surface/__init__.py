"""Surfaces with exact jets: mapped, twisted, of revolution; curvature; levels that bound surfaces."""
