"""First touch: of all places where two flanks may touch, the one that is ahead."""
