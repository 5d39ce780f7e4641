"""Bars of contact patterns for pages: where a pattern lies between toe and heel, root and tip, in per cent."""

from __future__ import annotations

import html
from collections.abc import Sequence

from gearmesh.answers.contact.pattern import PatternFigures
from gearmesh.view.report.card import number, percent


def pattern_bars(patterns: Sequence[PatternFigures], delta: float) -> str:
    """Return a table with two bars for each pattern, under a thickness of marking compound (mm), as HTML."""
    heads = "".join(
        f"<th>{head}</th>"
        for head in ("", "along the face", "centre", "length", "along the height", "centre", "width", "bias")
    )
    rows = "".join(map(_row, patterns))
    note = (
        f"Without load, under {number(1e3 * delta)} \u00b5m of marking compound. The face counts from the toe"
        f"{_toes(patterns)}, the working height from the root limit (form point). Bias: direction of the path of "
        "contact from root to tip, positive towards the heel."
    )
    table = f'<table class="patterns"><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'
    return f'<div class="scroll" tabindex="0">{table}</div><p class="hint">{html.escape(note)}</p>'


def _row(pattern: PatternFigures) -> str:
    bias = "" if pattern.bias is None else f"{number(round(pattern.bias, 1) + 0.0)}\u00b0"
    cells = (
        _bar("toe", "heel", pattern.face_ends, pattern.centre_face),
        percent(pattern.centre_face),
        percent(pattern.length),
        _bar("root", "tip", pattern.height_ends, pattern.centre_height),
        percent(pattern.centre_height),
        percent(pattern.width),
        bias,
    )
    name = f"{pattern.side}, {pattern.member} ({pattern.flank} flank)"
    return f"<tr><th>{html.escape(name)}</th>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _bar(low_end: str, high_end: str, ends: Sequence[float], centre: float) -> str:
    """Return the bar between two ends of a flank with the part that a pattern covers, and a mark at its centre."""
    low, high = ends
    words = f"from {low:.0f} to {high:.0f} % of the way from {low_end} to {high_end}"
    return (
        f'<span class="bar"><small>{low_end}</small><span role="img" aria-label="{words}" title="{words}">'
        f'<i style="left:{low:.2f}%;width:{high - low:.2f}%"></i><b style="left:{centre:.2f}%"></b></span>'
        f"<small>{high_end}</small></span>"
    )


def _toes(patterns: Sequence[PatternFigures]) -> str:
    """Return which ends are the toes, by members."""
    toes = {pattern.member: pattern.toe for pattern in patterns}
    words = ", ".join(f"{member}: {toe}" for member, toe in toes.items()) if len(set(toes.values())) > 1 else ""
    return f" ({words or next(iter(toes.values()))})"
