"""Mathematics without gears: frames, motions, surfaces, envelopes, curvature, root finders."""
