"""Tools beside the teeth that they generate: where they stand, and along which lines they touch."""
