"""Keyways for parallel keys of DIN 6885-1, the high form, by the bore.

The values are those of makers' catalogues: Ganter (technical information, "DIN 6885 keyway, key details") up to 44 mm,
and Siemens Flender (MD 31.1, 2016, p. 7/3) from 38 to 230 mm. Both agree in their common rows. No two sources were at
hand above 230 mm.
"""

from __future__ import annotations

#: largest bore of each range, width b of the keyway, and its depth t2 in the hub beyond the bore's surface
_KEYWAYS_MM = (
    (8.0, 2.0, 1.0),
    (10.0, 3.0, 1.4),
    (12.0, 4.0, 1.8),
    (17.0, 5.0, 2.3),
    (22.0, 6.0, 2.8),
    (30.0, 8.0, 3.3),
    (38.0, 10.0, 3.3),
    (44.0, 12.0, 3.3),
    (50.0, 14.0, 3.8),
    (58.0, 16.0, 4.3),
    (65.0, 18.0, 4.4),
    (75.0, 20.0, 4.9),
    (85.0, 22.0, 5.4),
    (95.0, 25.0, 5.4),
    (110.0, 28.0, 6.4),
    (130.0, 32.0, 7.4),
    (150.0, 36.0, 8.4),
    (170.0, 40.0, 9.4),
    (200.0, 45.0, 10.4),
    (230.0, 50.0, 11.4),
)
#: smallest bore with a keyway
MIN_BORE_MM = 6.0
#: largest bore with a keyway
MAX_BORE_MM = _KEYWAYS_MM[-1][0]


def keyway_in_hub(bore: float) -> tuple[float, float] | None:
    """Return width b and depth t2 (mm) of the keyway in a bore of a diameter (mm); None outside the table."""
    if not MIN_BORE_MM <= bore <= MAX_BORE_MM:
        return None
    return next((width, depth) for most, width, depth in _KEYWAYS_MM if bore <= most)
