"""Which cases: drawn from a seed that comes from outside the code."""

import hashlib
from dataclasses import asdict, dataclass, field

import numpy as np
from twin import hidden, liars
from worlds import faults

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
WORLDS = {"first": hidden, "second": faults}  # whose effects are hidden: `twin` or `worlds`
SECOND_KINDS = ("null", "single", "double", "outside", "without")
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
    world: str = "first"

    def as_dict(self):
        return asdict(self)


def number(seed, *words):
    """A seed of 63 bits from a seed word and more words, by SHA-256."""
    text = "|".join(str(word) for word in (seed, *words))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "big") >> 1


def shape_of(effect, random, world="first"):
    """Other parameters of an effect, uniform in their ranges."""
    entry = WORLDS[world].EFFECTS[effect]
    return {name: float(random.uniform(low, high)) for name, (low, high) in entry.shape.items()}


def _one(effect, snr, random, world):
    entry = WORLDS[world].EFFECTS[effect]
    signs = [sign for sign, limit in ((-1, entry.low), (1, entry.high)) if limit * sign > 0]
    return effect, float(snr), int(random.choice(signs)), shape_of(effect, random, world)


def draw(seed, counts, ladder=SNR_LADDER, world="first"):
    """Cases of each kind, `counts` a dict kind: number, in one of `WORLDS`.

    Single effects go through the catalogue and the ladder in a drawn order, so that any number is spread.
    ValueError if the world has no such kind.
    """
    kinds = KINDS if world == "first" else SECOND_KINDS
    unknown = {kind for kind, count in counts.items() if count} - set(kinds)
    if unknown:
        raise ValueError(f"kinds are {', '.join(kinds)}; got {', '.join(sorted(unknown))}")
    return [case for kind in kinds for case in _of_kind(seed, kind, counts.get(kind, 0), ladder, world)]


def _of_kind(seed, kind, count, ladder, world):
    source = WORLDS[world]
    words, before = ((), "") if world == "first" else ((world,), f"{world}-")
    order = np.random.default_rng(number(seed, *words, kind, "order"))
    names, outside = list(source.CATALOGUE), list(source.OUTSIDE)
    if world != "first":  # many faults: a short set must not always hold the same
        order.shuffle(outside)
    pairs = [(name, snr) for name in names for snr in ladder]
    strong = [snr for snr in ladder if snr >= 12] or [max(ladder)]
    # Effects one after the other, so that a short series does not miss one; rungs drawn.
    queue = []
    while len(queue) < count:
        block = [pairs[index] for index in order.permutation(len(pairs))]
        queue += block
    for index in range(count):
        case_seed = number(seed, *words, kind, index)
        random = np.random.default_rng(case_seed)
        base = {"name": f"{before}{kind}-{index:04d}", "kind": kind, "seed": case_seed, "world": world}
        if kind == "null":
            yield Case(**base)
        elif kind == "liar":
            yield Case(**base, noise=list(liars.LIARS)[index % len(liars.LIARS)])
        elif kind == "single":
            yield Case(**base, effects=(_one(*queue[index], random, world),))
        elif kind == "double":
            two = random.choice(names, 2, replace=False)
            snr = random.choice(strong)
            yield Case(**base, effects=tuple(_one(str(name), snr, random, world) for name in two))
        elif kind == "outside":
            name = outside[index % len(outside)]
            yield Case(**base, effects=(_one(name, random.choice(strong), random, world),))
        elif kind in ("without", "sabotage"):
            name = queue[index][0]
            extra = {"without": (name,)} if kind == "without" else {"sabotage": name}
            yield Case(**base, effects=(_one(name, 20.0, random, world),), **extra)
        else:
            name = list(PUZZLE)[index % len(PUZZLE)]
            yield Case(**base, options={"explanation": name})
