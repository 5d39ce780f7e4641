"""Searches for the best design: samples of the whole range, then methods of scipy from the best of them.

A search works on shares (n,) of the ranges of all variables, 0 to 1. Every method makes a merit small: the objective, or
for fronts of several objectives the largest of their weighted distances from the best values known (Chebyshev's).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.optimize.evaluations import Evaluated, best_of, front_of
from gearmesh.optimize.lockstep import Ask, in_lockstep
from gearmesh.optimize.objectives import Target
from gearmesh.optimize.variables import Variable, values_at
from gearmesh.records import dataclass
from gearmesh.study.plan import Value, sample_plan
from gearmesh.study.spreads import Spread

#: method of trust regions without derivatives
COBYQA_METHOD = "cobyqa"
#: differential evolution, which takes whole numbers and lists, too
EVOLUTION_METHOD = "evolution"
#: all methods
SEARCH_METHODS = (COBYQA_METHOD, EVOLUTION_METHOD)
#: share of the evaluations of a round that is sampled before its searches
SAMPLED_SHARE = 0.25
#: fewest designs of a sample beyond one per variable
MIN_SAMPLE = 2
#: evaluations of a search over the points of its first model, below which no further search starts
EVALUATIONS_PER_POINT = 5
#: limit of the searches side by side for one objective
MAX_SEARCHES = 4
#: least distance of the starts of two searches, in any share
START_DISTANCE = 0.15
#: first radius of a trust region, in shares of the ranges
FIRST_RADIUS = 0.1
#: last radius of a trust region, in shares of the ranges
LAST_RADIUS = 1e-4
#: relative room that a search keeps from every limit: it ends at limits from either side
LIMIT_MARGIN = 1e-3
#: fewest designs in a generation of the evolution
MIN_POPULATION = 8
#: designs per variable in a generation of the evolution
POPULATION_PER_VARIABLE = 4
#: limit of the generations of the evolution, which ask for few new designs in a small space
MAX_GENERATIONS = 300
#: steps between the weights of the searches for a front, by the number of objectives
WEIGHT_STEPS = {1: 1, 2: 5, 3: 3}
#: smallest weight of an objective in a merit
MIN_WEIGHT = 0.02
#: factor of the sum of the distances in a merit, by which dominated designs are worse
AUGMENTING_FACTOR = 0.05
#: limit of the rounds of samples and searches
MAX_ROUNDS = 5
#: relative gain of a round that is worth another one
WORTHWHILE_GAIN = 1e-3
#: score of a design that violates its limits, larger than any objective
UNFEASIBLE_SCORE = 1e12
#: evaluations of a round of an optimisation that ends by the clock
TIMED_ROUND_EVALUATIONS = 200

#: function that returns designs with their figures, in order, or None when the budget is spent
Evaluate = Callable[[list[tuple[Value, ...]]], "list[Evaluated] | None"]


def method_of(name: str | None, variables: Sequence[Variable]) -> str:
    """Return the method of a name, by default one that the variables allow. Raises ArgumentError for another one."""
    discrete = [each.key for each in variables if each.discrete]
    if name is None:
        return EVOLUTION_METHOD if discrete else COBYQA_METHOD
    if name not in SEARCH_METHODS:
        raise ArgumentError("method", name, must_be=f"one of {', '.join(SEARCH_METHODS)}")
    if name == COBYQA_METHOD and discrete:
        reason = f"needs ranges of real numbers, and {discrete[0]} is none; {EVOLUTION_METHOD} allows it"
        raise ArgumentError("method", name, reason=reason)
    return name


@dataclass(frozen=True)
class Merit:
    """Value that a search makes small: one objective, or the weighted distances of several from the best ones known."""

    #: signs (O,) that make objectives small
    signs: Array
    #: weights (O,)
    weights: Array
    #: best values (O,) known, with signs
    ideal: Array
    #: sizes (O,) of the objectives, by which distances are divided
    size: Array

    def of(self, design: Evaluated) -> float:
        """Return the merit of a design; NaN if it failed."""
        distance = (self.signs * design.objectives - self.ideal) / self.size * self.weights
        return float(distance.max() + AUGMENTING_FACTOR * distance.sum()) if len(distance) > 1 else float(distance[0])


@dataclass(frozen=True)
class Search:
    """Search of a space of variables for what is asked of them."""

    #: varied keys
    variables: tuple[Variable, ...]
    #: objectives and constraints
    target: Target
    #: method, one of `SEARCH_METHODS`
    method: str
    #: seed of samples and of the evolution
    seed: int
    #: number of designs; None for a search that `evaluate` ends
    budget: int | None
    #: function that returns designs with their figures
    evaluate: Evaluate
    #: function that returns all designs so far
    designs: Callable[[], Sequence[Evaluated]]

    def __call__(self) -> bool:
        """Ask for designs until the budget is spent, or no more is gained: then return True."""
        score = np.inf
        for number in range(MAX_ROUNDS):
            left = TIMED_ROUND_EVALUATIONS if self.budget is None else self.budget - len(self.designs())
            if left <= 0 or not self._round(left, self.seed + number):
                return False
            before, score = score, self._score
            one = len(self.target.objectives) == 1
            if one and number and before - score <= WORTHWHILE_GAIN * abs(before):
                return True
        return True

    @property
    def _score(self) -> float:
        """Best value of the objective, small if good; far larger if no design keeps the limits."""
        best = best_of(self.designs(), self.target)
        if best is None or not best.feasible:
            return np.inf if best is None else UNFEASIBLE_SCORE * (1.0 + best.violation)
        return float(-self.target.objectives[0].sense * best.objectives[0])

    def _round(self, left: int, seed: int) -> bool:
        """Sample the whole space, then search from its best designs; return False when the budget is spent."""
        count = len(self.variables)
        merits = len(_weights(len(self.target.objectives)))
        size = max(count + MIN_SAMPLE, round(SAMPLED_SHARE * left))
        if self.method == EVOLUTION_METHOD:
            size = min(max(MIN_POPULATION, POPULATION_PER_VARIABLE * count), max(size, MIN_POPULATION))
        sample = self._sample(size, seed)
        if self._answer(sample) is None:
            return False
        failed = self.designs()
        if failed and all(each.reason for each in failed):
            raise NoSolutionError(reason=f"all {len(failed)} designs of the first sample failed: {failed[0].reason}")
        left -= len(sample)
        if self.method == EVOLUTION_METHOD:
            return self._run([partial(self._evolve, merit, sample, seed) for merit in self._merits()])
        points = EVALUATIONS_PER_POINT * (2 * count + 1)
        starts = 1 if merits > 1 else min(max(left // points, 1), MAX_SEARCHES)
        most = max(left // (merits * starts), 2 * count + 2)
        # one after the other: COBYQA of scipy holds a lock while it runs
        return all(
            self._run([partial(self._descend, merit, start, most)])
            for merit in self._merits()
            for start in self._starts(merit, starts)
        )

    def _run(self, searches: Sequence[Callable[[Ask], None]]) -> bool:
        """Run searches side by side; return False when the budget is spent."""
        return in_lockstep(searches, self._answer)

    def _answer(self, shares: Sequence[Array]) -> list[Evaluated] | None:
        return self.evaluate([values_at(self.variables, each) for each in shares])

    def _sample(self, count: int, seed: int) -> list[Array]:
        """Return points (n,) of a Latin hypercube, in shares."""
        spreads = {each.key: Spread("uniform", (0.0, 1.0)) for each in self.variables}
        columns = sample_plan(spreads, count, "lhs", seed).columns.values()
        return list(np.array(list(columns), dtype=float).T)

    @property
    def _known(self) -> list[Evaluated]:
        """Designs with figures, those that keep the limits if any does."""
        known = [each for each in self.designs() if not each.reason]
        return [each for each in known if each.feasible] or known

    def _merits(self) -> list[Merit]:
        """Return the merit of the objective, or one for each set of weights of several."""
        signs = self.target.signs
        known = self._known
        known = front_of(known, self.target) or known
        table = np.array([signs * each.objectives for each in known]).reshape(-1, len(signs))
        ideal = table.min(axis=0) if len(table) else np.zeros(len(signs))
        width = np.ptp(table, axis=0) if len(table) else np.ones(len(signs))
        size = np.where(width > 0.0, width, np.maximum(np.abs(ideal), 1.0))
        return [Merit(signs, weights, ideal, size) for weights in _weights(len(signs))]

    def _shares(self, design: Evaluated) -> Array:
        shares = [each.share(value) for each, value in zip(self.variables, design.values, strict=True)]
        return np.array([np.nan if share is None else share for share in shares], dtype=float)

    def _starts(self, merit: Merit, count: int) -> list[Array]:
        """Return the best designs, not near each other, from which searches start; the middle if there is none."""
        known = [each for each in self.designs() if not each.reason]
        starts: list[Array] = []
        for design in sorted(known, key=lambda each: (each.violation, merit.of(each))):
            shares = self._shares(design)
            if np.isfinite(shares).all() and all(np.abs(shares - each).max() >= START_DISTANCE for each in starts):
                starts.append(shares)
            if len(starts) == count:
                break
        return starts or [np.full(len(self.variables), 0.5)]

    def _descend(self, merit: Merit, start: Array, most: int, ask: Ask) -> None:
        """Follow trust regions from a start, with COBYQA."""
        from scipy.optimize import Bounds, NonlinearConstraint, minimize

        at = _Asked(self, merit, ask)
        limits = (
            [NonlinearConstraint(lambda shares: at.room(shares) - LIMIT_MARGIN, 0.0, np.inf)]
            if self.target.constraints
            else []
        )
        minimize(
            at.merit,
            start,
            method="COBYQA",
            bounds=Bounds(np.zeros(len(start)), np.ones(len(start))),
            constraints=limits,
            options={
                "maxfev": most,
                "maxiter": 10 * most,
                "initial_tr_radius": FIRST_RADIUS,
                "final_tr_radius": LAST_RADIUS,
            },
        )

    def _evolve(self, merit: Merit, sample: Sequence[Array], seed: int, ask: Ask) -> None:
        """Evolve a population from a sample, with differential evolution."""
        from scipy.optimize import NonlinearConstraint, differential_evolution

        at = _Asked(self, merit, ask)
        counts = np.array([len(each.values) for each in self.variables])
        whole = counts > 0

        def shares(points: Array) -> Array:
            """Return the shares (n, S) of points, whose coordinates are shares, or numbers in a list."""
            return np.where(whole[:, None], (np.round(points) + 0.5) / np.maximum(counts, 1)[:, None], points)

        def each(of: Callable[[Array], object], points: Array) -> Array:
            table = shares(points.reshape(len(counts), -1)).T
            at.ask_for(list(table))
            return np.array([of(point) for point in table]).T

        limits = [NonlinearConstraint(partial(each, at.room), 0.0, np.inf)] if self.target.constraints else ()
        first = np.array(sample)
        differential_evolution(
            partial(each, at.merit),
            [(0.0, max(count - 1.0, 1.0)) for count in counts.tolist()],
            init=np.where(whole, np.minimum(np.floor(first * counts), counts - 1), first),
            integrality=whole,
            constraints=limits,
            maxiter=MAX_GENERATIONS,
            rng=np.random.default_rng(seed),
            polish=False,
            updating="deferred",
            vectorized=True,
        )


class _Asked:
    """Merit and room of designs that one search has asked for."""

    def __init__(self, search: Search, merit: Merit, ask: Ask) -> None:
        self._variables, self._merit, self._ask = search.variables, merit, ask
        known = [merit.of(each) for each in search.designs() if not each.reason]
        #: merit of a failed design
        self._failed = max(known, default=0.0) + 1.0
        self._limits = len(search.target.constraints)
        self._designs: dict[tuple[Value, ...], Evaluated] = {}

    def ask_for(self, points: Sequence[Array]) -> None:
        """Ask for the designs at some shares that are not known yet, all at once."""
        new = {values_at(self._variables, point): point for point in points}
        new = {values: point for values, point in new.items() if values not in self._designs}
        if new:
            self._designs.update(zip(new, self._ask(list(new.values())), strict=True))

    def _at(self, shares: Array) -> Evaluated:
        self.ask_for([shares])
        return self._designs[values_at(self._variables, shares)]

    def merit(self, shares: Array) -> float:
        """Return the merit at shares (n,)."""
        design = self._at(shares)
        return self._failed if design.reason else self._merit.of(design)

    def room(self, shares: Array) -> Array:
        """Return the room (C,) up to the limits at shares (n,); -1 for a failed design."""
        design = self._at(shares)
        return np.full(self._limits, -1.0) if design.reason else design.room


def _weights(objectives: int) -> list[Array]:
    """Return sets of weights (O,) of objectives: one, or all multiples of a step that sum to 1."""
    if objectives == 1:
        return [np.ones(1)]
    steps = WEIGHT_STEPS[objectives]
    sets = [each for each in itertools.product(range(steps + 1), repeat=objectives) if sum(each) == steps]
    return [np.maximum(np.array(each) / steps, MIN_WEIGHT) for each in sets]
