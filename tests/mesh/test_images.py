"""Sides that are each other's image are thinned once: mirror images of face gears, half a turn about the tooth of worm wheels."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import built_sample

from gearmesh.mesh.tessellate import tessellate


@pytest.mark.parametrize(
    ("sample", "member", "image"),
    [("face_gear", "gear", (1.0, -1.0, 1.0)), ("worm_drive", "wheel", (1.0, -1.0, -1.0))],
)
@pytest.mark.sweep_cases("worm_drive-wheel-image1")
def test_sides_have_the_nodes_of_their_image(sample: str, member: str, image: tuple[float, float, float]) -> None:
    tooth = built_sample(sample).members[member].tooth
    patches = {str(patch.region): patch for patch in tessellate(tooth, 0.02).patches}
    for link in ("flank", "fillet"):
        right, left = (patches[f"{link}_{side}"].points for side in ("right", "left"))
        assert len(right) == len(left)
        apart = np.linalg.norm((right * image)[:, None] - left, axis=-1)
        # the surfaces of both sides are solved to 1e-9 mm, their nodes are 0.1 mm apart and more
        assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-7
