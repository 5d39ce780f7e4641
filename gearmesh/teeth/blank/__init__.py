"""The blank that limits the teeth, and the body under them."""
