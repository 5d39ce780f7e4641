"""The wheel as it is cut: how its hob is fed, and over which face it has flanks."""
