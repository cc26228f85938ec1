"""From a case to the files of a laboratory, and the size of an effect in standard deviations of the data."""

import dataclasses
import hashlib
import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from powers import ladder
from twin import campaign, hidden, incident, liars
from twin.gas import Gas, Spectra, spectra
from twin.plasma import Plasma
from twin.sample import Sample
from twin.sensors import Spectrometer

CONDITION = "80kW"
PIXELS = 360
LINES = {  # multiplets whose strengths err on their own [nm]
    "O I 777": ("O I", 770.0, 785.0),
    "O I 844": ("O I", 840.0, 850.0),
    "N I 746": ("N I", 740.0, 750.0),
    "N I 821": ("N I", 815.0, 830.0),
    "N I 862": ("N I", 855.0, 866.6),
    "N I 869": ("N I", 866.6, 880.0),
    "N I 939": ("N I", 936.0, 948.0),
    "N I 1011": ("N I", 1008.0, 1022.0),
}
SYSTEM_ERROR, LINE_ERROR, POWER_ERROR = 0.08, 0.05, 0.08  # standard deviations of ln in a null
EMITTANCE_ERROR = 0.03


@dataclass(frozen=True)
class Base:
    """What is true besides hidden effects: drawn anew for every case, and never a finding."""

    seed: int
    power: float  # [W] numerical
    strengths: dict  # system or multiplet: ln of its factor
    emittance: float
    sample: dict  # overrides of `Sample`
    before_injection: float
    laboratory: int
    condition: str = "80kW"  # the simulation that the laboratory compares with


def draw_base(seed, laboratories, condition=CONDITION, power_error=POWER_ERROR):
    """A base from a seed: power, strengths of the gas, emittance, thermal history, laboratory."""
    random = np.random.default_rng([seed, 1])
    strengths = {name: float(random.normal(0, LINE_ERROR)) for name in LINES}
    for name in ("N I", "O I", "N2 1P", "N2+ Meinel", "NO 11000 A", "continuum"):
        strengths[name] = float(np.clip(random.normal(0, SYSTEM_ERROR), -0.24, 0.24))
    off = power_error * float(np.clip(random.normal(), -2.5, 2.5))
    sample = {
        "cold_wall_heat_flux": float(random.uniform(4.0e5, 5.0e5)),
        "areal_heat_capacity": float(random.uniform(7.5e3, 11e3)),
        "holder_heat_capacity": float(random.uniform(7e3, 14e3)),
        "contact": float(random.uniform(25, 60)),
        "rise_time": float(random.uniform(0.8, 2.5)),
    }
    return Base(
        seed=int(seed),
        power=int(condition[:-2]) * 1e3 * float(np.exp(off)),
        strengths=strengths,
        emittance=float(np.clip(random.normal(0.85, EMITTANCE_ERROR), 0.78, 0.92)),
        sample=sample,
        before_injection=float(random.uniform(1.4, 1.9)),
        laboratory=int(random.integers(laboratories)),
        condition=condition,
    )


@dataclass(frozen=True)
class Bench:
    """The files that all cases share."""

    response: xr.Dataset
    sightlines: dict  # numerical power [W]: profile
    table: xr.Dataset  # composition of the gas
    spectra: Spectra
    # numerical power [W]: file of the flow field, for what a sample scatters
    flows: dict = field(default_factory=dict)
    _views: dict = field(default_factory=dict)

    def view(self, power):
        """What shines on the sample at a simulated power [W]; None without its flow field."""
        if power not in self.flows:
            return None
        if power not in self._views:
            flow = xr.load_dataset(self.flows[power])
            self._views[power] = incident.view(flow, self.table.temperature.values)
        return self._views[power]

    def profile(self, power):
        """Keyword arguments of `Gas` that depend on the power [W] alone.

        The profile lies between those of the neighbouring simulated powers, linearly in the logarithm; what
        the sample sees is that of the nearest one.
        """
        nearest = min(self.sightlines, key=lambda one: abs(one - power))
        at = self.table.sel(pressure=5000.0, method="nearest")
        number = 5000.0 / (1.380649e-23 * at.temperature.values)
        distance = self.sightlines[nearest].path_distance.values
        powers = sorted(self.sightlines)
        kelvin = [
            np.interp(distance, line.path_distance.values, line.temperature.values)
            for line in map(self.sightlines.get, powers)
        ]
        return {
            "distance": distance,
            "temperature": np.array(
                [np.interp(np.log(power), np.log(powers), column) for column in np.transpose(kelvin)]
            ),
            "table_temperature": at.temperature.values,
            "table_density": {
                str(name): number * at.mole_fraction.sel(species=name).values for name in at.species.values
            },
            "view": self.view(nearest),
        }

    def gas(self, base):
        """The true gas of a base."""
        radiance = self.spectra.at(base.power).copy()
        weakest = self.spectra.radiance[0].sum(axis=0)
        for row, system in enumerate(self.spectra.systems):
            name = system if system in base.strengths else "continuum"
            radiance[row] *= np.exp(base.strengths[name])
        for name, (system, first, last) in LINES.items():
            inside = (self.spectra.centres > first * 1e-9) & (self.spectra.centres < last * 1e-9)
            radiance[self.spectra.systems.index(system), inside] *= np.exp(base.strengths[name])
        return Gas(
            self.spectra.centres, self.spectra.systems, radiance, weakest=weakest, **self.profile(base.power)
        )

    def scene(self, base):
        """The scene of a base without hidden effects."""
        return campaign.Scene(
            condition=base.condition,
            end=330.0,
            pyrometer_period=0.5,
            spectrometer_period=1.0,
            spectrometer_integration_time=0.9,
            centred_exposures=True,
            sample=dataclasses.replace(Sample(), emittance=base.emittance, **base.sample),
            plasma=Plasma(before_injection=base.before_injection, drift=0.0, swing=0.0),
            spectrometer=spectrometer(),
        )

    def clean(self, scene, gas, base, warmer=0.0):
        """Signals (2, t) and count rates (S, W) without noise."""
        return campaign.clean_output(scene, self.response, [(1.0, as_dataset(gas))], base.seed, warmer)

    def record(self, scene, gas, base):
        """The test file and the truth of a scene."""
        return campaign.record(scene, self.response, [(1.0, as_dataset(gas))], base.seed)


def spectrometer():
    """The spectrometer of all blind cases."""
    return Spectrometer(pixels=PIXELS)


def as_dataset(gas):
    """The gas as the twin reads it from a file."""
    return xr.Dataset({"gas_radiance": ("wavelength", gas.total)}, {"wavelength": gas.centres})


def load(results, cache=None):
    """The bench from a folder of results of the main job; spectra on bins are kept in `cache` (.npz)."""
    results = Path(results)
    files = ladder(results / "radiation")
    if not files:
        raise ValueError(f"{results / 'radiation'}: no radiation files; run the main job first")
    digest = hashlib.sha256(b"".join(path.read_bytes()[-4096:] for path in files.values())).hexdigest()
    kept = _from_cache(cache, digest)
    if kept is None:
        kept = spectra([xr.load_dataset(path) for path in files.values()], list(files))
        if cache:
            _keep(kept, digest, Path(cache))
    return Bench(
        response=xr.load_dataset(results / "instrument/response.nc"),
        sightlines={
            power: xr.load_dataset(results / "sightline" / path.name) for power, path in files.items()
        },
        table=xr.load_dataset(results / "gas/air11.nc"),
        spectra=kept,
        flows={power: results / "flow" / path.name for power, path in files.items()},
    )


def _keep(kept, digest, cache):
    """Store spectra, whole or not at all: several runs may share a folder."""
    cache.parent.mkdir(parents=True, exist_ok=True)
    part = cache.with_name(f"{os.getpid()}-{cache.name}")
    np.savez(part, digest=digest, **dataclasses.asdict(kept) | {"systems": np.array(kept.systems)})
    os.replace(part, cache)


def _from_cache(cache, digest):
    if not cache or not Path(cache).is_file():
        return None
    with np.load(cache) as kept:
        if str(kept["digest"]) != digest:
            return None
        systems = tuple(str(name) for name in kept["systems"])
        return Spectra(kept["power"], kept["centres"], systems, kept["radiance"])


def apply(scene, gas, effects, noise=None):
    """The scene with effects (dicts of effect, amplitude, shape) and a kind of noise."""
    for one in effects:
        scene = hidden.hide(scene, one["effect"], one["amplitude"], gas, one.get("shape"))
    return liars.lie(scene, noise) if noise else scene
