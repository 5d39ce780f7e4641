"""Mathematics without gears: frames, motions, what a surface is, envelopes, curvature, root finders."""
