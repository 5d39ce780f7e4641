"""Cutter location files: the words of APT (ISO 4343) that readers of cutter locations have in common, one statement a line.

PARTNO        name of the design and the member
PPRINT        what it is, one line each
UNITS/MM
MULTAX/ON     locations have a tool axis
CUTTER/d,r,e,f,a,b,h    7-parameter cutter: diameter, corner radius, distance of the corner's centre from the axis (0) and its
              height over the tip (r), both angles 0, and the height
LOADTL/n
RAPID         of the next GOTO alone
FEDRAT/v,MMPM
GOTO/x,y,z,i,j,k        the tip of the tool (not the ball's centre), mm, in the member's own frame, and the unit axis to the shank
END, FINI
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.motion import AXIS_DECIMALS, DECIMALS, ToolMotion

#: characters of a line of text
WIDTH = 65


def cls_text(title: str, notes: Sequence[str], motion: ToolMotion, ball: BallCutter, feed: float) -> str:
    """The file of a motion at a feed, mm/min."""
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
    """Statements of all positions, with the words that change what goes before them."""
    table = np.concatenate((motion.tips, motion.axes), axis=1) + 0.0
    template = "GOTO/" + ",".join([f"%.{DECIMALS}f"] * 3 + [f"%.{AXIS_DECIMALS}f"] * 3)
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
    """Text in the letters that every reader has, not longer than a line."""
    kept = "".join(c for c in text.replace("\n", " ") if c.isascii() and c.isprintable() and c not in "$'")
    return kept[:WIDTH].strip()
