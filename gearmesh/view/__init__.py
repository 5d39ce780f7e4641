"""Pictures as scenes, the renderer, plots."""
