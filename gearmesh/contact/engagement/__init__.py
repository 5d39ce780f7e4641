"""A tooth pair through its engagement, the gears through their mesh cycle and through whole turns."""
