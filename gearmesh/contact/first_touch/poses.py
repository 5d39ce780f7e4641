"""Sampled fields of many assemblies at one rotation, from polynomials in the pose of the pinion in the gear's frame.

Small errors of assembly change the advance at a node of the pinion's grid smoothly. Few assemblies are sampled exactly: those
through which polynomials have the smallest weights at the others. The remaining nodes are sums of theirs, with the same weights
for all nodes and rotations. Assemblies with the largest weights are sampled as well and tell the error. Nodes with a larger error,
or with an advance in some of these assemblies only, are sampled exactly in all.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: length (mm) over which advances change their slopes: terms of polynomials fall by the errors of assembly over it
BENDING_LENGTH_MM = 5.0
#: largest term (mm) that is left out of the polynomials
SMALLEST_TERM_MM = 3e-6
#: highest degree of the polynomials
HIGHEST_DEGREE = 4
#: spread (mm) of poses along a direction up to which they do not differ
SAME_POSE_MM = 1e-9
#: assemblies at which polynomials are checked
CHECKED_ASSEMBLIES = 8
#: least number of assemblies by the number of those that are sampled exactly
LEAST_SHARE = 3
#: largest error (rad) of an advance by polynomials, at the assemblies that are checked
FIELD_ERROR_RAD = 2e-9
#: largest error (mm) of a distance from a limit, which is a line with small corners
LIMIT_ERROR_MM = 1e-5


@dataclass(frozen=True)
class Poses:
    """Weights of few assemblies in polynomials of the poses of M assemblies."""

    #: transforms from the pinion's frame to the gear's, both at rest
    own_to_gear: Rigid
    #: assemblies (S,) that are sampled
    sampled: NDArray[np.intp]
    #: assemblies that are sampled as well, for the error
    checked: NDArray[np.intp]
    #: weights (M, S) of the sampled assemblies
    weights: Array

    @staticmethod
    def of(own_to_gear: Rigid, middle: Array, reach: float) -> Poses | None:
        """Return the weights for a flank within `reach`, mm, of its `middle` (3,); None if there are too few assemblies for it."""
        rotation, count = own_to_gear.rotation, len(own_to_gear.rotation)
        turned = np.swapaxes(rotation[0], -1, -2) @ rotation
        lean = 0.5 * np.stack(
            [turned[:, j, i] - turned[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1))],
            axis=-1,
        )
        pose = np.concatenate((own_to_gear.point(middle), reach * lean), axis=1)
        pose -= pose.mean(axis=0)
        directions = np.linalg.svd(pose, full_matrices=False)[2]
        place = pose @ directions.T
        span = np.abs(place).max(axis=0)
        place, span = place[:, span > SAME_POSE_MM] / span[span > SAME_POSE_MM], span[span > SAME_POSE_MM]
        share = span / BENDING_LENGTH_MM
        columns = [np.ones(count)]
        for degree in range(1, HIGHEST_DEGREE + 1):
            for term in map(list, combinations_with_replacement(range(len(span)), degree)):
                if degree == 1 or BENDING_LENGTH_MM * share[term].prod() > SMALLEST_TERM_MM:
                    columns.append(place[:, term].prod(axis=1))
        if LEAST_SHARE * (len(columns) + CHECKED_ASSEMBLIES) > count:
            return None
        terms = np.linalg.qr(np.stack(columns, axis=-1))[0]
        sampled = _spread(terms)
        weights = np.linalg.solve(terms[sampled].T, terms.T).T
        sizes = np.abs(weights).sum(axis=1)
        sizes[sampled] = 0.0
        return Poses(own_to_gear, sampled, np.argsort(sizes)[-CHECKED_ASSEMBLIES:], weights)

    def same(self, own_to_gear: Rigid) -> bool:
        """Return True if the poses are those of other assemblies, in the same order."""
        return np.array_equal(self.own_to_gear.rotation, own_to_gear.rotation) and np.array_equal(
            self.own_to_gear.translation, own_to_gear.translation
        )

    def fit(self, advance: Array, beyond: Array) -> PosedField:
        """Return the field of all assemblies from advances (S + C, K) and distances (4, S + C, K) of those that are sampled
        or checked.
        """
        count, by_check = len(self.sampled), self.weights[self.checked]
        apart = np.abs(by_check @ advance[:count] - advance[count:]).max(axis=0)
        off = np.abs(by_check @ beyond[:, :count] - beyond[:, count:]).max(axis=(0, 1))
        nowhere = np.isnan(advance).all(axis=0) & ~(beyond <= 0.0).all(axis=0).any(axis=0)
        sure = (nowhere | (apart <= FIELD_ERROR_RAD)) & (off <= LIMIT_ERROR_MM)
        return PosedField(self.weights, advance[:count], beyond[:, :count], np.flatnonzero(~sure))


@dataclass(frozen=True)
class PosedField:
    """Sampled field of M assemblies at K nodes, by the fields of S of them."""

    #: weights (M, S)
    weights: Array
    #: advances (S, K), rad
    advance: Array
    #: distances (4, S, K), mm, outside the limits of the gear's flank
    beyond: Array
    #: nodes (E,) that are to be sampled exactly
    exact: NDArray[np.intp]

    def at(self, which: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return advances (G, K) and distances (4, G, K) of some of the assemblies."""
        weights = self.weights[which]
        return weights @ self.advance, weights @ self.beyond


def _spread(terms: Array) -> NDArray[np.intp]:
    """Return S rows of orthonormal terms (M, S) that span as much as possible: of the rest the largest, one after the other."""
    left, size = terms.copy(), np.square(terms).sum(axis=1)
    rows = []
    for _ in range(terms.shape[1]):
        row = int(size.argmax())
        rows.append(row)
        own = left[row] / np.sqrt(size[row])
        left -= np.outer(left @ own, own)
        size = np.square(left).sum(axis=1)
        size[rows] = -1.0
    return np.array(rows)
