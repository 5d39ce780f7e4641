"""One typed result for every question about gears, each figure with unit, symbol and meaning; solved once, shown by others."""
