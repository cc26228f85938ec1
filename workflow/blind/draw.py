"""Which cases: drawn from a seed that comes from outside the code."""

import hashlib
from dataclasses import asdict, dataclass, field

import numpy as np
from twin import hidden, liars

SNR_LADDER = (2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 50.0)
LABORATORIES = 16  # the bias of a lamp is the largest error of the temperature: few would not show its spread
# Six explanations of more light than the simulated power would give; amplitudes and shapes as they are
# hidden. A mirror gives 15 % at most and the spectrum of the gas: it explains nothing. A sample that scatters
# one part in twenty of what it reflects brings the smooth light near 1.05 um up by a third.
PUZZLE = {
    "refl": ("refl", 1.0, {"diffuse": 0.05}),
    "T_exc": ("T_exc", 0.10, {}),
    "ripple": ("ripple", 0.15, {}),
    "P_eff": ("P_eff", 0.12, {}),
    "path": ("path", 0.4, {}),
    "calibration": ("calibration", 0.4, {}),
}
KINDS = ("null", "liar", "single", "double", "outside", "without", "sabotage", "puzzle")


@dataclass(frozen=True)
class Case:
    """What to hide; amplitudes follow from the SNR when the case is made."""

    name: str
    kind: str
    seed: int
    effects: tuple = ()  # of (effect, SNR, sign, shape)
    noise: str | None = None
    without: tuple = ()  # causes taken out of the analyser's catalogue
    sabotage: str | None = None  # cause whose formula in the analyser is made wrong
    options: dict = field(default_factory=dict)

    def as_dict(self):
        return asdict(self)


def number(seed, *words):
    """A seed of 63 bits from a seed word and more words, by SHA-256."""
    text = "|".join(str(word) for word in (seed, *words))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big") >> 1


def shape_of(effect, random):
    """Other parameters of an effect, uniform in their ranges."""
    return {
        name: float(random.uniform(low, high)) for name, (low, high) in hidden.EFFECTS[effect].shape.items()
    }


def _one(effect, snr, random):
    entry = hidden.EFFECTS[effect]
    signs = [sign for sign, limit in ((-1, entry.low), (1, entry.high)) if limit * sign > 0]
    return effect, float(snr), int(random.choice(signs)), shape_of(effect, random)


def draw(seed, counts, ladder=SNR_LADDER):
    """Cases of each kind, `counts` a dict kind: number.

    Single effects go through the catalogue and the ladder in a drawn order, so that any number is spread.

    Raises
    ------
    ValueError
        If a kind is unknown.
    """
    unknown = set(counts) - set(KINDS)
    if unknown:
        raise ValueError(f"kinds are {', '.join(KINDS)}; got {', '.join(sorted(unknown))}")
    return [case for kind in KINDS for case in _of_kind(seed, kind, counts.get(kind, 0), ladder)]


def _of_kind(seed, kind, count, ladder):
    order = np.random.default_rng(number(seed, kind, "order"))
    names = list(hidden.CATALOGUE)
    pairs = [(name, snr) for name in names for snr in ladder]
    strong = [snr for snr in ladder if snr >= 12] or [max(ladder)]
    # Effects one after the other, so that a short series does not miss one; rungs drawn.
    queue = []
    while len(queue) < count:
        block = [pairs[index] for index in order.permutation(len(pairs))]
        queue += block
    for index in range(count):
        case_seed = number(seed, kind, index)
        random = np.random.default_rng(case_seed)
        base = {"name": f"{kind}-{index:04d}", "kind": kind, "seed": case_seed}
        if kind == "null":
            yield Case(**base)
        elif kind == "liar":
            yield Case(**base, noise=list(liars.LIARS)[index % len(liars.LIARS)])
        elif kind == "single":
            yield Case(**base, effects=(_one(*queue[index], random),))
        elif kind == "double":
            two = random.choice(names, 2, replace=False)
            snr = random.choice(strong)
            yield Case(**base, effects=tuple(_one(str(name), snr, random) for name in two))
        elif kind == "outside":
            name = list(hidden.OUTSIDE)[index % len(hidden.OUTSIDE)]
            yield Case(**base, effects=(_one(name, random.choice(strong), random),))
        elif kind in ("without", "sabotage"):
            name = queue[index][0]
            extra = {"without": (name,)} if kind == "without" else {"sabotage": name}
            yield Case(**base, effects=(_one(name, 20.0, random),), **extra)
        else:
            name = list(PUZZLE)[index % len(PUZZLE)]
            yield Case(**base, options={"explanation": name})
