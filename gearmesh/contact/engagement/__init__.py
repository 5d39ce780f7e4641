"""A pair of teeth through its engagement, the gears through their mesh cycle and through whole turns."""
