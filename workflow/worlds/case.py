"""Cases of the second laboratory: world, laboratory, sample and what is hidden, all drawn from seeds that
come from outside."""

import dataclasses
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr
from powers import ladder

from worlds import laboratory, sample
from worlds.engine import CENTRES, World
from worlds.faults import EFFECTS, MICRON, Context
from worlds.laboratory import SMOOTH, Record, Scene, planck

WORLDS = 6  # gases of one set of cases, half of them with the scatter of published accuracies
MOST = 1.2e6  # spectra times pixels of one test
POWER_ERROR, EMITTANCE_ERROR = 0.05, 0.03
SLOPE, SLOPE_ERROR = 0.08, 0.005  # of the emittance: per um, and of its ratio between the bands
PRESSURE = 5000.0  # [Pa] of the main job


@dataclass(frozen=True)
class Base:
    """What is true besides hidden effects."""

    seed: int
    world: int
    laboratory: int
    condition: str
    power: float  # [W]
    pressure: float  # [Pa]
    angle: float  # of the sight line [deg]
    sample: dict
    stated_emittance: float
    before_injection: float
    flicker: float
    swing: float
    off: float
    end: float
    slope: float  # of the emittance [um-1]
    slope_error: float  # stated over true ratio of the emittances in the bands, less one


@dataclass
class Bench:
    """Files that all cases share: responses and sight lines; worlds and laboratories of one seed."""

    response: xr.Dataset
    lines: dict  # power [W]: (distance, temperature)
    conditions: list  # powers [W] whose gas the analyser can vary
    angle: float
    worlds: list
    pressures: list
    laboratories: list


def load(results, seed, count):
    """The bench from results of the main job, `seed` a number, with `count` laboratories."""
    results, lines, angle = Path(results), {}, 35.0
    files = ladder(results / "sightline")
    for power, path in files.items():
        with xr.open_dataset(path) as line:
            angle = float(line.attrs.get("angle", angle))
            lines[power] = (line.path_distance.values, line.temperature.values)
    if not lines:
        raise ValueError(f"{results / 'sightline'}: no sight lines; run the main job first")
    varied = [
        power for power, path in files.items() if (results / "radiation_variations" / path.name).exists()
    ]
    conditions = varied or list(lines)
    random = np.random.default_rng([seed % 2**63, 31])
    seeds = random.integers(2**31, size=WORLDS + count)
    pressures = [
        PRESSURE
        if index % 2 == 0
        else float(np.round(100 * np.exp(random.uniform(np.log(15), np.log(300))), -1))
        for index in range(WORLDS)
    ]
    with xr.open_dataset(results / "instrument/response.nc") as response:
        response = response.load()
    worlds = [World(int(one), scattered=index >= WORLDS // 2) for index, one in enumerate(seeds[:WORLDS])]
    rooms = [laboratory.draw(int(one)) for one in seeds[WORLDS:]]
    return Bench(response, lines, conditions, angle, worlds, pressures, rooms)


def draw(seed, bench):
    """A base from a seed; conditions are those that the simulation has."""
    random = np.random.default_rng([seed, 32])
    world, lab = int(random.integers(WORLDS)), int(random.integers(len(bench.laboratories)))
    condition = float(random.choice(bench.conditions))
    power = condition * np.exp(POWER_ERROR * np.clip(random.normal(), -2.5, 2.5))
    body = sample.draw(random)
    off = float(random.uniform(120, 300))
    return Base(
        int(seed),
        world,
        lab,
        f"{condition / 1e3:g}kW",
        float(np.clip(power, min(bench.lines), max(bench.lines))),
        bench.pressures[world],
        float(35.0 if random.random() < 0.6 else random.uniform(30, 40)),
        asdict(body),
        float(np.clip(body.emittance + random.normal(0, EMITTANCE_ERROR), 0.2, 0.98)),
        float(random.uniform(0.8, 1.8)),
        float(random.uniform(0.004, 0.02)),
        float(random.uniform(0, 0.002)),
        off,
        off + float(random.uniform(20, 60)),
        float(SLOPE * np.clip(random.normal(), -2.5, 2.5)),
        float(random.normal(0, SLOPE_ERROR)),
    )


@dataclass
class Stage:
    """One case set up: the scene without effects, the context of effects, the recording laboratory."""

    bench: Bench
    base: Base
    _variants: dict = field(default_factory=dict)

    @property
    def world(self):
        return self.bench.worlds[self.base.world]

    @cached_property
    def lab(self):
        """The laboratory; a slower frame rate where its spectra would fill the disk."""
        lab = self.bench.laboratories[self.base.laboratory]
        least = (self.base.end + 40) * lab.pixels / MOST
        return dataclasses.replace(lab, period=max(lab.period, least))

    def path(self, power):
        """Distance and temperature along the sight line at a power [W], linear in its logarithm between
        conditions."""
        powers = sorted(self.bench.lines)
        distance = self.bench.lines[powers[0]][0]
        rows = [np.interp(distance, *self.bench.lines[one]) for one in powers]
        place = np.clip(np.log(power / np.array(powers[0])) / np.log(powers[-1] / powers[0]), 0, 1)
        marks = np.log(np.array(powers) / powers[0]) / np.log(powers[-1] / powers[0])
        kelvin = np.array([np.interp(place, marks, column) for column in np.transpose(rows)])
        stretch = np.sin(np.radians(self.bench.angle)) / np.sin(np.radians(self.base.angle))
        return distance * stretch, kelvin

    def light(self, power=None, warmer=1.0, wall=None, **options):
        """Light of the gas by component (C, bins)."""
        distance, kelvin = self.path(power or self.base.power)
        if wall is not None:  # the layer of 5 mm before the surface
            kelvin = kelvin + np.clip(1 - distance / 5e-3, 0, 1) * (wall - 350.0)
        return self.world.radiance(distance, kelvin * warmer, self.base.pressure, **options)

    @cached_property
    def components(self):
        return self.light()

    def strengths(self, faint):
        """Changes of light (bins,) by a standard deviation of each strength that a world draws.

        Left out are those of less than a share `faint` of the light.
        """
        hottest, whole = self.path(self.base.power)[1].max(), self.components.sum()
        for place, size, share in self.world.shares(hottest, self.base.pressure):
            light = share * self.components[place]
            if light.sum() > faint * whole:
                yield size * light

    def variant(self, kind, amplitude):
        """Total light (bins,) with one property of the gas off, from a parabola in ln of the light by
        component."""
        if kind not in self._variants:
            step, more = {
                "P_eff": (0.15, lambda a: self.light(power=np.clip(self.base.power * (1 + a), 4.5e4, 1.4e5))),
                "ripple": (0.06, lambda a: self.light(warmer=1 + a)),
                "T_exc": (0.04, lambda a: self.light(excitation=round(1 + a, 3))),
                "T_vib": (0.10, lambda a: self.light(vibration=round(1 + a, 3))),
                "selfabs": (0.5, lambda a: self.light(depth=0.5)),
                "bl": (1.0, lambda a: self.light(wall=1600.0)),
            }[kind]
            both = kind in ("P_eff", "ripple")
            base = np.maximum(self.components, 1e-30)
            up = np.log(np.maximum(more(step), 1e-30) / base)
            down = np.log(np.maximum(more(-step), 1e-30) / base) if both else -up
            self._variants[kind] = base, (up - down) / (2 * step), (up + down) / (2 * step**2)
        base, slope, bend = self._variants[kind]

        def at(a):
            return base * np.exp(np.clip(a * slope + a**2 * bend, -20, 20))

        if kind == "ripple":
            return np.mean(
                [at(amplitude * one) for one in np.sin(np.pi * (np.arange(8) + 0.5) / 8 * 2)], axis=0
            ).sum(axis=0)
        if kind == "selfabs":  # the factor (1 - exp(-tau)) / tau at 0.5 gives tau
            tau = np.linspace(1e-9, 3.0, 400)
            depth = np.interp(-np.exp(0.5 * slope), np.expm1(-tau) / tau, tau) * amplitude / 0.5
            return (base * -np.expm1(-np.maximum(depth, 1e-12)) / np.maximum(depth, 1e-12)).sum(axis=0)
        return at(amplitude).sum(axis=0)

    @cached_property
    def scene(self):
        """The scene without hidden effects."""
        base, body = self.base, sample.Sample(**self.base.sample)
        before = max(20.0, 4 * self.lab.period * self.lab.has_spectrometer)
        time = laboratory.grid(-before, base.off, base.end)
        kelvin = body.history(time, base.off)
        plasma = (time < base.off).astype(float)
        colour = base.sample["emittance"] * (1 + base.slope * (MICRON - 0.95))
        surface = colour * planck(SMOOTH, kelvin[:, None]) * (time >= 0)[:, None]
        random = np.random.default_rng([base.seed, 33])
        swing = base.swing * np.sin(2 * np.pi * time / random.uniform(60, 300) + random.uniform(0, 6.3))
        amplitude = plasma * np.where(time < 0, base.before_injection, 1.0) * (1 + swing)
        flat = np.ones((1, SMOOTH.size))
        lab = self.lab
        # Calibrated through the window, as files of this format are: its change since is left.
        path = {one: flat * (1 + lab.window_error[k]) for k, one in enumerate("ps")}
        hot = 320 + 60 * np.clip(time / 200, 0, 1)  # the windows glow, too little to matter
        glow = 0.02 * planck(SMOOTH, hot[:, None])
        return Scene(
            time=time,
            kelvin=kelvin,
            plasma=plasma,
            off=base.off,
            emittance=base.sample["emittance"],
            surface={"p": surface + glow, "s": surface + glow},
            gas=[("ps", amplitude, self.components.sum(axis=0))],
            path=path,
            fine=np.ones(CENTRES.size),
            bands=laboratory.true_bands(lab, self.bench.response),
            shift=np.zeros(time.size),
        )

    @cached_property
    def record(self):
        return Record(self.lab, self.scene, self.base.seed, self.base.flicker)

    @cached_property
    def context(self):
        """Sizes by which effects are scaled, from the base alone."""
        after = self.scene.copy(
            surface={one: 0 * light for one, light in self.scene.surface.items()},
            gas=[("ps", np.ones(self.scene.time.size), self.scene.gas[0][2])],
        )
        return Context(
            lab=self.lab,
            total=self.scene.gas[0][2],
            continuum=self.components[-1],
            variant=self.variant,
            signals=self.record.signals(after, np.array([1.0]))[:, 0],
            rate=self.record.rates(after)[0],
            highest=(self.record.signals(self.scene).max(axis=1), self.record.rates(self.scene).max()),
            seed=self.base.seed,
        )

    def colour_ratio(self):
        """Emittance in the wide band over that in the narrow one, of a surface of 1600 K."""
        light = self.scene.bands * planck(SMOOTH, 1600.0)
        wide, narrow = light @ (1 + self.base.slope * (MICRON - 0.95)) / light.sum(axis=1)
        return float(wide / narrow)

    def hidden(self, effects):
        """The scene with effects (dicts of effect, amplitude, shape)."""
        scene = self.scene
        for one in effects:
            scene = EFFECTS[one["effect"]].apply(
                scene, one["amplitude"], one.get("shape") or {}, self.context
            )
        return scene

    def test(self, effects):
        """The test file of the laboratory."""
        scene, base, lab = self.hidden(effects), self.base, self.lab
        cold = self.scene.time[(self.scene.kelvin > 620) & (self.scene.time > 0)]
        least = max(0.5, 4 / lab.pyrometer_rate)  # a mean needs samples
        attributes = {
            "title": "Test of a second laboratory",
            "origin": "synthetic",
            "condition": base.condition,
            "injection_time": 0.0,
            "plasma_off_time": base.off,
            "reference_window": [0.0, float(np.round(max(least, cold[0] if cold.size else 5.0), 1))],
            "emittance": base.stated_emittance,
            "emittance_uncertainty": EMITTANCE_ERROR,
        }
        if lab.has_pyrometer:
            attributes |= {
                "window_transmittance_pyrometer": lab.windows[0],
                "pyrometer_integration_time": lab.integration,
                "emittance_slope": self.colour_ratio() * (1 + base.slope_error),
                "emittance_slope_uncertainty": SLOPE_ERROR,
            }
        if lab.has_spectrometer:
            attributes |= {
                "window_transmittance_spectrometer": lab.windows[1],
                "spectrometer_integration_time": lab.exposure,
                "spectrometer_fwhm": lab.fwhm,
            }
        without = scene.copy(gas=[(w, 0 * a, light) for w, a, light in scene.gas])
        test = self.record.dataset(scene, without, attributes)
        if lab.has_pyrometer:
            random = np.random.default_rng([base.seed, 34])
            test["chamber_pressure"] = "time", base.pressure * (1 + random.normal(0, 0.003, test.time.size))
        return test

    def temperature(self, time):
        """True surface temperature (t,) [K]."""
        return np.interp(time, self.scene.time, self.scene.kelvin)
