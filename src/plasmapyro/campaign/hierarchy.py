"""The normal hierarchical model of a campaign: laws, their scatter, and the numbers of each test."""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import logsumexp

# of ln(simulated over electric power) at the reference power, before any test
EFFICIENCY = np.log(0.5), 0.5
EXPONENT = 0.5  # of the efficiency in the electric power
FOULING = 0.03  # [1] of the throughput that a window loses from one run to the next
PIECE = 0.01  # [1] ASSUME: emittance of one sample over that of its material
SCATTER = {  # of an instrument from test to test, ASSUME: mounting, warming up, linearisation of the fits
    "ratio": 5e-4,
    "lamp": 0.05,  # [K]
    "edge_wide": 0.05,  # [nm]
    "edge_narrow": 0.05,
    "tail": 1e-3,
}
SCALE_SCATTER = 5e-4
# Scatter of the efficiency about its law, and of what a window loses in a run: any of these, alike probable.
SCATTERS = np.stack(
    np.meshgrid(np.geomspace(1e-2, 0.1, 5), np.geomspace(5e-4, 0.02, 5), indexing="ij"), axis=-1
).reshape(-1, 2)
WINDOWS = ("gain_pyrometer", "gain_spectrometer")
GROUPS = ("efficiency", "window", "emittance", "instrument")
WIDE = 5.0  # of the prior standard deviation: how far off a test may be that does not belong
ODD = np.log(0.01 / 0.99)  # log odds that a group of a test does not belong, before any test


@dataclass(frozen=True)
class Test:
    """One test: `electric_power` [W], and laws of what it shares, after and before its data.

    `after`, `before` : `diagnosis.fit.prior.Normal`, None for a test that is to come; `own_prior`: before
    is what instruments state, not what other tests say; `temperature`: as in the report of a diagnosis.
    """

    name: str
    run: int  # since the first of the campaign
    cleanings: int  # before it
    electric_power: float
    material: str
    after: object = None
    before: object = None
    misfit: float = 1.0
    own_prior: bool = True
    temperature: dict = field(default_factory=dict)

    def message(self):
        """Information (d, d) and pull (d,) that the data alone give about the names of `after`."""
        inverse, prior = (np.linalg.inv(law.covariance) for law in (self.after, self.before))
        pull = inverse @ self.after.mean - prior @ self.before.mean
        return (inverse - prior) / self.misfit, pull / self.misfit


def group_of(name):
    """The part of the hierarchy that a shared number belongs to."""
    if name in ("power", "emittance"):
        return {"power": "efficiency"}.get(name, name)
    return "window" if name in WINDOWS else "instrument"


def slope_of(test, stated):
    """Variance of the ratio of a test that no other shares: between the bands a slope of its emittance,
    which a pyrometer by itself does not see, counts as ratio."""
    own = _first([test.before] if test.before is not None and test.own_prior else [], "ratio")
    sigmas = [_first([law], "ratio")[1] for law in stated if "ratio" in law.names]
    return max(own[1] ** 2 - min(sigmas) ** 2, 0.0) if own else 0.0


class Network:
    """Numbers, each normal about a linear function of those before it."""

    def __init__(self):
        self.index, self.rows = {}, []

    def add(self, name, mean, variance, parents=()):
        """`variance` : number, or function (scatter of the efficiency, of a window) -> number."""
        self.index[name] = len(self.rows)
        self.rows.append((mean, variance, dict(parents)))

    def add_block(self, names, law):
        """Numbers with a joint `Normal` law, one after the other."""
        for place, name in enumerate(names):
            before = slice(0, place)
            weight = np.linalg.solve(law.covariance[before, before], law.covariance[before, place])
            mean = law.mean[place] - weight @ law.mean[before]
            variance = law.covariance[place, place] - weight @ law.covariance[before, place]
            self.add(name, mean, variance, zip(names[:place], weight, strict=True))

    def information(self):
        """For each of `SCATTERS`: information (h, D, D), pull (h, D), and log of the density at 0 (h,)."""
        size = len(self.rows)
        rows, mean = np.eye(size), np.array([one for one, _, _ in self.rows])
        for place, (_, _, parents) in enumerate(self.rows):
            for name, weight in parents.items():
                rows[place, self.index[name]] -= weight
        variance = np.array(
            [[one(*pair) if callable(one) else one for _, one, _ in self.rows] for pair in SCATTERS]
        )
        weighted = rows / variance[:, :, None]
        return (
            rows.T @ weighted,
            np.einsum("hij,i->hj", weighted, mean),
            -0.5 * np.sum(np.log(variance) + mean**2 / variance, axis=1),
        )


def network(tests, reference_power):
    """The hierarchy of tests in the order of their dates.

    .. math:: \\ln\\frac{P_{sim}}{P_{el}} = a + b \\ln\\frac{P_{el}}{P_0} + s, \\qquad
              g_{t} = g_{t-1} - f + w, \\qquad \\ln\\varepsilon = \\ln\\varepsilon_{material} + p

    A cleaning starts the throughput g of a window anew; scatters s, w and p are independent.
    """
    found = Network()
    found.add("efficiency", *_squared(*EFFICIENCY))
    found.add("exponent", *_squared(0.0, EXPONENT))
    for name in WINDOWS:
        found.add(f"fouling {name}", *_squared(0.0, FOULING))
    stated = [one.before for one in tests if one.before is not None and one.own_prior]
    clean = {name: _first(stated, name) for name in WINDOWS}
    instrument = []
    for law in stated:
        new = [name for name in law.names if group_of(name) == "instrument" and name not in instrument]
        found.add_block(new, law.of(new))
        instrument += new
    for place, test in enumerate(tests):
        own = [one for one in tests if one.material == test.material and one.before is not None]
        material, here = f"emittance of {test.material}", test.name
        if material not in found.index and own:
            first = next((one for one in own if one.own_prior), own[0])
            found.add(material, *_squared(*_first([first.before], "emittance")))
        if material in found.index:
            found.add(f"emittance {here}", 0.0, PIECE**2, {material: 1.0})
        distance = np.log(test.electric_power / reference_power)
        law = {"efficiency": 1.0, "exponent": distance}
        found.add(f"power {here}", np.log(test.electric_power), lambda s, _: s**2, law)
        before = tests[place - 1] if place and tests[place - 1].cleanings == test.cleanings else None
        for name in WINDOWS:
            if clean[name] is None:
                continue
            if before is None:
                found.add(f"{name} {here}", *_squared(*clean[name]))
            else:
                runs = test.run - before.run
                found.add(
                    f"{name} {here}",
                    0.0,
                    lambda _, w, runs=runs: max(runs, 1) * w**2,
                    {f"{name} {before.name}": 1.0, f"fouling {name}": -float(runs)},
                )
        for name in instrument:
            scatter = SCALE_SCATTER if name.startswith("scale_") else SCATTER[name]
            own = slope_of(test, stated) if name == "ratio" else 0.0
            found.add(f"{name} {here}", 0.0, scatter**2 + own, {name: 1.0})
    return found


def _squared(mean, sigma):
    return mean, sigma**2


def _first(laws, name):
    """Mean and standard deviation of a number in the first law that has it, or None."""
    for law in laws:
        if name in law.names:
            return float(law.of([name]).mean[0]), float(law.of([name]).sigma[0])
    return None


@dataclass(frozen=True)
class Joint:
    """What a campaign says: `mean` and `covariance` of all numbers `index`; `weight` of `SCATTERS`;
    `odd` {(name of a test, group)} that do not belong."""

    index: dict
    mean: np.ndarray
    covariance: np.ndarray
    weight: np.ndarray
    odd: tuple = ()

    def number(self, name):
        """Mean and standard deviation."""
        at = self.index[name]
        return float(self.mean[at]), float(np.sqrt(self.covariance[at, at]))


class Campaign:
    """Tests in the order of their dates, the next one among them if it has no data."""

    def __init__(self, tests, reference_power):
        self.tests = tests
        net = network(tests, reference_power)
        self.index = net.index
        self.prior = net.information()
        self.messages = {one.name: (one, *one.message()) for one in tests if one.after is not None}
        self.summed = [self._of(name) for name in self.messages]

    def _of(self, name, group=None):
        """Information and pull of a test on all numbers, and a log; `group` of it off by any amount."""
        test, matrix, pull = self.messages[name]
        log = 0.0
        if group is not None:
            mine = [place for place, one in enumerate(test.after.names) if group_of(one) == group]
            if not mine:
                return None
            narrow = np.diag((WIDE * self.stated_sigma(test)[mine]) ** -2.0)
            block = matrix[np.ix_(mine, mine)] + narrow
            share = np.linalg.solve(block, np.column_stack([matrix[mine], pull[mine]]))
            log = 0.5 * (
                pull[mine] @ share[:, -1] - np.linalg.slogdet(block)[1] + np.linalg.slogdet(narrow)[1]
            )
            matrix, pull = matrix - matrix[:, mine] @ share[:, :-1], pull - matrix[:, mine] @ share[:, -1]
        at = [self.index[f"{one} {name}"] for one in test.after.names]
        return at, matrix, pull, log

    def stated_sigma(self, test):
        """Standard deviations (d,) of the numbers of a test as instruments state them."""
        laws = [one.before for one, _, _ in self.messages.values() if one.own_prior]
        return np.array([_first([*laws, test.before], name)[1] for name in test.after.names])

    def solve(self, odd=(), without=None):
        """For each of `SCATTERS`, with groups {(test, group)} free and without the data of one test: mean
        (h, D), covariance (h, D, D), and log of its evidence (h,)."""
        information, pull, log = (part.copy() for part in self.prior)
        free = dict(odd)
        for name, plain in zip(self.messages, self.summed, strict=True):
            if name == without:
                continue
            at, matrix, vector, shift = self._of(name, free[name]) if name in free else plain
            information[:, np.ix_(at, at)[0], np.ix_(at, at)[1]] += matrix
            pull[:, at] += vector
            log = log + shift
        covariance = np.linalg.inv(information)
        mean = np.einsum("hij,hj->hi", covariance, pull)
        log = log + 0.5 * (np.sum(mean * pull, axis=1) - np.linalg.slogdet(information)[1])
        return mean, covariance, log

    def joint(self, odd=(), without=None):
        """`Joint` law, the scatters averaged over."""
        mean, covariance, log = self.solve(odd, without)
        weight = np.exp(log - log.max())
        weight /= weight.sum()
        middle = weight @ mean
        whole = np.einsum("h,hij->ij", weight, covariance) + (weight * (mean - middle).T) @ (mean - middle)
        return Joint(self.index, middle, whole, weight, tuple(odd))

    def odd_ones(self):
        """Groups of tests that do not belong, one by one as long as the data make them likely.

        A test has one such group at most. What a free group does to the evidence is a change of low rank
        (matrix determinant lemma and Woodbury's identity).
        """
        odd = []
        while len(odd) < len(self.messages) // 2:
            law = self.solve(odd)
            tried = {
                (name, group): logsumexp(self._freed(law, place, group)) + ODD
                for place, name in enumerate(self.messages)
                for group in GROUPS
                if name not in dict(odd) and self._of(name, group) is not None
            }
            best = max(tried, key=tried.get, default=None)
            if best is None or not tried[best] > logsumexp(law[2]):
                break
            odd.append(best)
        return tuple(odd)

    def _freed(self, law, place, group):
        """Log of the evidence (h,) of a law of `solve` once a group of one of its tests is free."""
        mean, covariance, log = law
        at, plain, pull, _ = self.summed[place]
        _, matrix, vector, shift = self._of(list(self.messages)[place], group)
        less, push = matrix - plain, vector - pull
        inner = covariance[:, np.ix_(at, at)[0], np.ix_(at, at)[1]]
        change = np.eye(len(at)) + less @ inner
        moved = mean[:, at] + inner @ push
        gain = (2 * mean[:, at] + inner @ push) @ push - np.einsum(
            "hi,hi->h", moved, np.linalg.solve(change, (moved @ less)[..., None])[..., 0]
        )
        return log + shift + 0.5 * (gain - np.linalg.slogdet(change)[1])
