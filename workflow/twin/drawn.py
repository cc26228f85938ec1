"""Campaigns of which all is drawn: truth from what a laboratory states, data by what real diagnoses see.

No code of the package. Each test takes the linear part of a diagnosis that was made: which combinations of
the shared numbers its data see, how well, and how its temperature follows them.
"""

import numpy as np

REFERENCE = 160e3  # [W]
PIECE = 0.01  # scatter of the emittance of samples
CLEANED = 6  # place of the test before which windows are cleaned
WINDOWS = ("gain_pyrometer", "gain_spectrometer")


class Seen:
    """What the data of a diagnosed test see: `posterior` as in `diagnosis.json`."""

    def __init__(self, posterior):
        self.names = posterior["names"]
        self.told = posterior
        self.prior = np.array(posterior["prior"]["covariance"])
        self.centre = np.array(posterior["prior"]["mean"])
        after = np.array(posterior["covariance"]) * posterior["misfit"]
        value, vector = np.linalg.eigh(np.linalg.inv(after) - np.linalg.inv(self.prior))
        value = np.maximum(value, 0.0)  # what fits that are not linear leave below
        self.information = (vector * value) @ vector.T
        self.root = vector * np.sqrt(value)
        slope, sigma = (np.array(posterior["temperature"][key]) for key in ("slope", "sigma"))
        own = sigma**2 - np.einsum("td,de,te->t", slope, after, slope)
        self.slope, self.own = slope, np.sqrt(np.maximum(own, 0.0))

    def variance(self, name):
        """Of a number, before the data."""
        at = self.names.index(name)
        return self.prior[at, at]

    def diagnosis(self, true, random):
        """The posterior of a test whose shared numbers are `true` {name: value}, and the true temperature."""
        true = np.array([true[name] for name in self.names])
        pull = self.information @ true + self.root @ random.normal(size=true.size)
        covariance = np.linalg.inv(np.linalg.inv(self.prior) + self.information)
        after = covariance @ (np.linalg.solve(self.prior, self.centre) + pull)
        temperature = np.array(self.told["temperature"]["value"])
        error = self.slope @ (after - true) + self.own * random.normal()
        variance = np.einsum("td,de,te->t", self.slope, covariance, self.slope) + self.own**2
        return self.told | {
            "mean": after.tolist(),
            "covariance": covariance.tolist(),
            "misfit": 1.0,
            "temperature": self.told["temperature"]
            | {"value": (temperature + error).tolist(), "sigma": np.sqrt(variance).tolist()},
        }, temperature


def campaign(seen, seed, *, odd=None, last=None):
    """Truth, and tests as (name, date, electric power, material, posterior).

    The truth by the names of `campaign.hierarchy`, and `temperature` of the last test [K]. `seen`: electric
    power [W], material and `Seen` of each test; `odd`: a place of a test, a number, and by how much it does
    not belong; `last`: of the last test, if it is another kind of record.
    """
    random = np.random.default_rng(seed)
    first = seen[0][2]
    instrument = [name for name in first.names if name not in ("emittance", "power", *WINDOWS)]
    at = [first.names.index(name) for name in instrument]
    constant = dict(
        zip(
            instrument, random.multivariate_normal(0 * np.array(at), first.prior[np.ix_(at, at)]), strict=True
        )
    )
    stated = {name: one for _, name, one in reversed(seen)}
    known = {name: (one.centre[0], np.sqrt(one.prior[0, 0])) for name, one in stated.items()}
    emittance = {name: random.normal(*law) for name, law in sorted(known.items())}
    efficiency, exponent = np.log(0.5) + random.normal(0, 0.1), random.normal(0, 0.3)
    fouling = random.uniform(0, 0.015, 2)
    scatter, window = (np.exp(random.uniform(*np.log(ends))) for ends in ((0.005, 0.05), (0.001, 0.008)))
    clean = np.sqrt(np.diag(first.prior)[[first.names.index(name) for name in WINDOWS]])
    made = []
    for place, (electric, material, one) in enumerate(seen):
        if place in (0, CLEANED):
            gain = clean * random.normal(size=2)
        else:
            gain = gain - fouling + window * random.normal(size=2)
        law = efficiency + exponent * np.log(electric / REFERENCE)
        values = constant | {
            "emittance": emittance[material] + PIECE * random.normal(),
            **dict(zip(WINDOWS, gain, strict=True)),
            "power": np.log(electric) + law + scatter * random.normal(),
        }
        if odd is not None and odd[0] == place:
            values[odd[1]] += odd[2]
        record = last if last is not None and place == len(seen) - 1 else one
        # of an emittance whose colour nothing sees
        slope = record.variance("ratio") - first.variance("ratio")
        if slope > 1e-9:
            values["ratio"] += np.sqrt(slope) * random.normal()
        told, temperature = record.diagnosis(values, random)
        made.append((f"run{place:02d}", f"2026-03-{place + 1:02d}", electric, material, told))
    truth = constant | {
        "efficiency": efficiency,
        "exponent": exponent,
        **{f"emittance of {name}": value for name, value in emittance.items()},
        **{f"fouling {name}": one for name, one in zip(WINDOWS, fouling, strict=True)},
        **{f"{name} {made[-1][0]}": values[name] for name in (*WINDOWS, "power")},
        "temperature": temperature,
    }
    return truth, made


def plan_and_reports(made):
    """Plan by the schema of the package, and reports, of tests as `campaign` makes them."""
    keys = ("name", "date", "electric_power_kw", "material", "diagnosis")
    tests = [
        dict(zip(keys, (name, day, power / 1e3, material, f"{name}.json"), strict=True))
        for name, day, power, material, _ in made
    ]
    plan = {
        "reference_power_kw": REFERENCE / 1e3,
        "cleanings": [f"2026-03-{CLEANED + 1:02d}"],
        "tests": tests,
    }
    return plan, {name: {"schema": "plasmapyro-diagnosis-1", "posterior": told} for name, *_, told in made}
