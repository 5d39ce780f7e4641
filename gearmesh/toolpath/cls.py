"""Cutter location files: APT (ISO 4343), restricted to the words that all readers understand, one statement a line.

PARTNO        name of the design and the member
PPRINT        description, one line each
UNITS/MM
MULTAX/ON     locations have a tool axis
CUTTER/d,r,e,f,a,b,h    7-parameter cutter: diameter, corner radius, distance of the corner's centre from the axis (0)
              and its height over the tip (r), both angles 0, and the height
LOADTL/n
RAPID         for the next GOTO only
FEDRAT/v,MMPM
GOTO/x,y,z,i,j,k        tip of the tool (not the ball's centre), mm, in the member's frame, and unit axis to the shank
END, FINI
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.motion import AXIS_DECIMALS, COORDINATE_DECIMALS, ToolMotion

#: characters of the text of a statement
MAX_TEXT_LENGTH = 65


def cls_text(title: str, notes: Sequence[str], motion: ToolMotion, ball: BallCutter, feed: float) -> str:
    """Return the file of a motion at a feed, mm/min."""
    r, d = ball.radius, ball.diameter
    head = [
        f"PARTNO {_plain(title)}",
        *(f"PPRINT {_plain(note)}" for note in notes),
        "UNITS/MM",
        "MULTAX/ON",
        f"CUTTER/{d:.6f},{r:.6f},{0.0:.6f},{r:.6f},{0.0:.6f},{0.0:.6f},{ball.length + r:.6f}",
        "LOADTL/1",
    ]
    return "\n".join((*head, *_moves(motion, feed), "END", "FINI", ""))


def _moves(motion: ToolMotion, feed: float) -> list[str]:
    """Return the statements of all positions, with the statements that change space, feed or rapid before them."""
    table = np.concatenate((motion.tips, motion.axes), axis=1) + 0.0
    template = "GOTO/" + ",".join([f"%.{COORDINATE_DECIMALS}f"] * 3 + [f"%.{AXIS_DECIMALS}f"] * 3)
    lines: list[str] = []
    was_rapid = True
    for row, rapid, space, changed in zip(
        table.tolist(),
        motion.rapid.tolist(),
        motion.space.tolist(),
        np.diff(motion.space, prepend=-1).tolist(),
        strict=True,
    ):
        if changed:
            lines.append(f"PPRINT SPACE {space + 1}")
        if rapid:
            lines.append("RAPID")
        elif was_rapid:
            lines.append(f"FEDRAT/{feed:.4f},MMPM")
        lines.append(template % tuple(row))
        was_rapid = rapid
    return lines


def _plain(text: str) -> str:
    """Return the text with only the characters that every reader accepts, cut to the length of a line."""
    kept = "".join(c for c in text.replace("\n", " ") if c.isascii() and c.isprintable() and c not in "$'")
    return kept[:MAX_TEXT_LENGTH].strip()
