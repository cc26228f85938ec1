"""Campaigns of an invented laboratory: what is true, and what the diagnosis of each test would write.

No code of the package; every test measures some combinations of the shared numbers with known errors.
"""

import numpy as np

NAMES = ("emittance", "gain_pyrometer", "gain_spectrometer", "ratio", "lamp", "edge_wide", "power")
STATED = np.array([0.06, 0.02, 0.02, 0.004, 1.7, 1.0, 0.08])
# What the data of one test see, each with its error: levels of the instruments, ratio and edge, power.
SEEN = (
    ({"emittance": 1.0, "gain_pyrometer": 1.0, "lamp": -0.008}, 0.004),
    ({"emittance": 1.0, "gain_spectrometer": 1.0, "lamp": -0.008}, 0.004),
    ({"ratio": 1.0, "edge_wide": 0.003}, 0.0008),
    ({"edge_wide": 1.0}, 0.4),
    ({"power": 1.0}, 0.016),
)
BARE = SEEN[:1]  # without a spectrometer, temperature comes from the bands, and nothing checks them
POWERS = (120e3, 160e3, 200e3)
REFERENCE = 160e3
SAMPLES = 0.01  # scatter of the emittance


def campaign(seed, *, tests=10, cleaned=6, odd=None, bare=False):
    """Truth, and tests as (name, date, electric power, material, posterior by the schema).

    `odd` : (place of a test, number, by how much) that does not belong; `bare`: the last test has no spectra.
    """
    random = np.random.default_rng(seed)
    truth = {
        "efficiency": 0.5 * np.exp(random.normal(0, 0.1)),
        "exponent": random.normal(0, 0.3),
        "fouling": random.uniform(0, 0.015, 2),
        "ratio": random.normal(0, STATED[3]),
        "lamp": random.uniform(-3, 3),
        "edge_wide": random.normal(0, 1.0),
        "emittance": {
            "C/SiC": 0.85 * np.exp(random.normal(0, 0.06)),
            "SiC": 0.9 * np.exp(random.normal(0, 0.06)),
        },
        "scatter": np.exp(random.uniform(np.log(0.005), np.log(0.05))),
        "window": np.exp(random.uniform(np.log(0.001), np.log(0.008))),
    }
    stated = {"C/SiC": 0.85, "SiC": 0.9}
    gain, made = random.normal(0, 0.02, 2), []
    for place in range(tests):
        if place == cleaned:
            gain = random.normal(0, 0.02, 2)
        elif place:
            gain = gain - truth["fouling"] + random.normal(0, truth["window"], 2)
        material = ("C/SiC", "SiC")[place % 3 == 2]
        electric = POWERS[place % 3] if place < 9 else POWERS[int(random.integers(3))]
        law = np.log(truth["efficiency"]) + truth["exponent"] * np.log(electric / REFERENCE)
        values = {
            "emittance": np.log(truth["emittance"][material]) + random.normal(0, SAMPLES),
            "gain_pyrometer": gain[0],
            "gain_spectrometer": gain[1],
            **{name: truth[name] for name in ("ratio", "lamp", "edge_wide")},
            "power": np.log(electric) + law + random.normal(0, truth["scatter"]),
        }
        if odd is not None and odd[0] == place:
            values[odd[1]] += odd[2]
        before = {"emittance": np.log(stated[material]), "power": np.log(0.5 * electric)}
        made.append(
            (
                f"run{place:02d}",
                f"2026-03-{place + 1:02d}",
                electric,
                material,
                _told(values, before, random, BARE if bare and place == tests - 1 else SEEN),
            )
        )
    truth["gain"] = gain  # of the last test
    truth["values"] = values
    return truth, made


def _told(values, before, random, seen=SEEN):
    true = np.array([values[name] for name in NAMES])
    mean = np.array([before.get(name, 0.0) for name in NAMES])
    rows = np.array([[row.get(name, 0.0) for name in NAMES] for row, _ in seen])
    error = np.array([one for _, one in seen])
    data = rows @ true + error * random.normal(size=error.size)
    prior = np.diag(STATED**-2.0)
    covariance = np.linalg.inv(prior + (rows / error[:, None] ** 2).T @ rows)
    after = covariance @ (prior @ mean + rows.T @ (data / error**2))
    slope = np.array([5.0, 4.0, 3.0, 1500.0, 0.9, 6.0, 0.0])  # [K], of a reading in which nothing else errs
    variance = slope @ covariance @ slope
    return {
        "names": list(NAMES),
        "mean": after.tolist(),
        "covariance": covariance.tolist(),
        "prior": {"mean": mean.tolist(), "covariance": np.diag(STATED**2).tolist()},
        "misfit": 1.0,
        "with_priors": False,
        "temperature": {
            "time": [100.0],
            "value": [1500.0 + float(slope @ (after - true))],
            "sigma": [float(np.sqrt(variance))],
            "slope": [slope.tolist()],
        },
    }


def plan_and_reports(made):
    """Plan by the schema of the package, and reports, of tests as `campaign` makes them."""
    plan = {
        "reference_power_kw": REFERENCE / 1e3,
        "cleanings": ["2026-03-07"],
        "tests": [
            {
                "name": name,
                "date": day,
                "diagnosis": f"{name}.json",
                "electric_power_kw": power / 1e3,
                "material": material,
            }
            for name, day, power, material, _ in made
        ],
    }
    return plan, {name: {"schema": "plasmapyro-diagnosis-1", "posterior": told} for name, *_, told in made}
