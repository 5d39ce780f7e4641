"""Places of files in the checkout."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
SAMPLES = ROOT / "samples"
PACKAGE = ROOT / "gearmesh"
