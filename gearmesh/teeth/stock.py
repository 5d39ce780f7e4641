r"""Teeth with stock on their flanks alone, as they are before grinding, hard cutting or honing.

The flank with stock is the parallel surface of the finished flank, from the tip down to the form point. From there a
ramp, as a tool with protuberance leaves it, goes straight down to the fillet. Fillet, root and lands are those of the
finished tooth. Chamfers of the tip lie on their planes, and grow with the stock.

                    |  | flank with stock
      finished flank|  |
         form point |  |
                     \ /  ramp, RAMP_ANGLE_DEG from the flank
                      (
              fillet   \
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmesh.errors import DesignError, KindError
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, Polynomials, spline_through
from gearmesh.kernel.surface.continued import Continued
from gearmesh.kernel.surface.offset import Parallel
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import Surface
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.offset import CROSSED_TEETH, LINK_SAMPLES, crosses_itself, distance_refusal, with_moved_teeth
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import PROOF_STATIONS, Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: angle between the flank with stock and the ramp below it: a protuberance of usual hobs has half of the pressure angle
RAMP_ANGLE_DEG = 15.0
#: lengths of the ramp, in lengths over which a straight fillet lets it meet, that are tried in turn
RAMP_LENGTHS = (1.5, 6.0, 24.0)
#: failures of trimming of a ramp that does not cross the fillet, and their reason
RAMP_FAILURES = ("crossing", "undercut")
MISSED_FILLET_REASON = "the ramp under the flank with stock does not meet the fillet"
#: stations at which the line is found where finished flanks that are undercut end
LINE_STATIONS = 33
#: largest spread of the parameters of that line, in flank lengths, that counts as 0
MAX_LINE_SPREAD = 1e-9
#: step along the face for derivatives of the continued flank, as a share of the face
STEP_SHARE = 1e-3
#: accuracy of the largest stock, as a share of the tooth's height
STOCK_ACCURACY = 1e-3


def stock_member(member: Member, stock: float) -> Member:
    """Return the member with stock (mm) on all its flanks. Raises ArgumentError, with the largest stock that works."""
    if not stock:
        return member
    return with_moved_teeth(member, lambda tooth: stock_tooth(tooth, stock))


def stock_tooth(tooth: Tooth, stock: float) -> Tooth:
    """Return the tooth with stock (mm) on its flanks. Raises ArgumentError, with the largest stock that works."""
    made = _trial(tooth, stock)
    if isinstance(made, Tooth):
        return made
    raise distance_refusal("stock", stock, tooth.height, STOCK_ACCURACY, lambda d: _trial(tooth, d, RAMP_LENGTHS[:1]))


def _trial(tooth: Tooth, stock: float, lengths: tuple[float, ...] = RAMP_LENGTHS) -> Tooth | str:
    """Return the tooth with stock, or the reason why it is wrong."""
    if not stock:
        return tooth
    reason = ""
    for length in lengths:
        try:
            made = _covered(tooth, stock, length)
            made.prove()
        except TrimError as failure:
            reason = MISSED_FILLET_REASON if failure.what in RAMP_FAILURES else str(failure)
        except (KindError, DesignError) as failure:
            reason = str(failure)
        else:
            s, sections = np.linspace(0.0, 1.0, LINK_SAMPLES), made.sections(np.linspace(0.0, 1.0, PROOF_STATIONS))
            points = np.concatenate([made.grid(region, s, sections).points[1:] for region in made.regions])
            return CROSSED_TEETH if crosses_itself(made, points) else made
    return reason


def _covered(tooth: Tooth, stock: float, length: float) -> Tooth:
    """Return the tooth with stock on its flanks, before any test; see `RAMP_LENGTHS` for `length`."""
    right, left = (_side(tooth, which, stock, length) for which in Side)
    made = replace(tooth, right=right, left=left)
    if tooth.tip_edge is None or tooth.tip_edge.rounded:
        return made
    # a chamfer on the same plane begins lower on a flank farther out
    with_stock, finished = (base.sharp_tip.sections([0.5]) for base in (made, tooth))
    widths = [float((ends.left.tip_angle - ends.right.tip_angle)[0]) for ends in (with_stock, finished)]
    arm = float(tooth.joint.arm(tooth.sharp_tip.flank_grid(Side.RIGHT, [1.0], [0.5]).points)[0, 0])
    return replace(made, tip_edge=tooth.tip_edge.grown(0.5 * arm * (widths[0] - widths[1])))


def _side(tooth: Tooth, which: Side, stock: float, length: float) -> ToothSide:
    """Return one side with stock on its flank."""
    side, smooth = tooth.side(which), tooth.side(which).smooth_flank
    sense = float(np.sign(side.tip - side.form_point[0]))
    line, shift = _line(tooth, which, sense)
    v = along(side.flank, np.full(2, line), np.array(tooth.blank.faces), tooth.blank.axial)[0]
    middle = tooth.flank_grid(which, [0.0, 1.0], [0.5]).points[:, 0]
    rate = float(np.linalg.norm(middle[1] - middle[0])) / abs(side.tip - line)
    angle = math.radians(RAMP_ANGLE_DEG)

    def ramp(surface: Surface) -> Continued:
        step = STEP_SHARE * abs(float(v[1] - v[0]))
        return Continued(Parallel(surface, stock), line, sense, angle, rate, step, shift)

    return replace(
        side,
        flank=ramp(side.flank),
        form_point=(line - sense * length * stock / math.tan(angle) / rate, side.form_point[1]),
        tip_corner=None if side.tip_corner is None else replace(side.tip_corner, crossed=True),
        flank_breaks=(*side.flank_breaks, line),
        creases=(*side.creases, line),
        smooth_flank=None if smooth is None else lambda p, v: ramp(smooth(p, v)),
        generated=side.generated or side,
        sharp=True,
        crossed=True,
        crossing_end=line,
        generation=None,
    )


def _line(tooth: Tooth, which: Side, sense: float) -> tuple[float, Polynomials | None]:
    """Return the parameter of the line in which the finished flank ends, and the rest of it over v where it changes.

    It changes along the face where the flank is undercut. A flank with breaks at constant parameters ends at the line
    that is nearest to the tip.
    """
    side, sharp = tooth.side(which), tooth.sharp_ends
    t = np.linspace(0.0, 1.0, LINE_STATIONS)
    ends = sharp.ends(which, t).form_point_flank
    line = float(sense * (sense * ends).max())
    if np.ptp(ends) <= MAX_LINE_SPREAD * abs(side.tip - line) or side.flank_breaks:
        return line, None
    v = along(side.flank, ends, sharp.stations(t), sharp.blank.axial)[0]
    order = np.argsort(v)
    return line, spline_through(v[order], ends[order] - line, CUBIC_DEGREE)
