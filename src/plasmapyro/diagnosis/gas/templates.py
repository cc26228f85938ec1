"""What the gas looks like to each instrument: templates on the nodes of an instrument, and how they vary."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro.radiation.path import CONTINUA
from plasmapyro.radiation.slit import FWHM_PER_SIGMA

ATOMIC_GAP = 1.0e-9  # [m] of darkness: lines of an atom with less between them share a strength (a multiplet)
# [m] between sequences of N2 1P: 2, 1, 0 more quanta of vibration
MOLECULAR_EDGES = np.array([700, 800, 945, 1200]) * 1e-9
ATOMS = ("N I", "O I")
BANDS_OF = "N2 1P"
OF_CORE = ("core_temperature", "ripple")
BY_TEMPERATURE = ("excitation", "vibration")
CHANGED = {"excitation": ATOMS, "vibration": (BANDS_OF,), "optical_depth": ATOMS}  # whose light varies
RIPPLE = np.cos(np.pi * (np.arange(8) + 0.5) / 8)  # sines of equal weight: exact for powers up to 15
LARGEST_POWER = 0.4  # of ln P, five prior standard deviations: beyond, the gas counts as no hotter
WARMTH_OF_POWER = 0.3
"""Relative change of the temperature of the gas per relative change of the power, where no other power is
simulated. ASSUME: as the spectra of the default torch have it, 0.29 at 80 kW and 0.37 to 0.46 at 60 kW."""
DEPTH_ERROR = 0.6
"""Of ln of an optical depth. ASSUME: 4 % of the temperature times 13, the exponent of the lower level of
O I 777 nm (9.1 eV) at 8000 K, and 0.3 of a Stark width (H. R. Griem, Spectral Line Broadening (1974))."""
BEYOND = 3.0  # standard deviations to which the simulated gas may be stretched
WARMTHS = 61  # changes of the temperature that are tried for a power
TINY = 1e-9  # [1] of the light: a system that does not shine
SMALL, REST = 1.5e-3, "other"  # [1], of the light: smaller groups of lines join the rest, and its name


@dataclass(frozen=True)
class GasLibrary:
    """Spectra of the gas behind a slit, for all simulated powers and for single things varied.

    `wavelength` (K,) [m]; `log_power` (C,) [1] increasing; `radiance` (C, K) [W m-2 sr-1 m-1];
    `group` (G, K): the light of the condition in groups of lines, adding up to it; `core`: (relative change
    of the temperature of the gas (X,), radiance (X, K)), or None; `variation`: name -> (amplitude (L,),
    radiance (L, K)); `addition`: name -> (K,); `weakest` (K,): of the least power; `share`: name of a
    variation -> (C, K) of the light of each power, that of the systems that it changes.
    """

    condition: str
    power: float
    wavelength: np.ndarray
    slit_fwhm: float
    log_power: np.ndarray
    radiance: np.ndarray
    group_name: tuple
    group: np.ndarray
    variation: dict
    addition: dict
    weakest: np.ndarray
    systems: tuple  # (M,) names of the radiating systems of the strength modes
    strength_modes: np.ndarray  # (M, K) errors of the simulated spectrum, see `radiation.uncertainty`
    shape_systems: tuple  # the same of the shape modes; '' of errors that the whole light shares
    shape_modes: np.ndarray
    causes: tuple  # (M,) of the strength modes, and
    shape_causes: tuple  # of the shape modes: see `radiation.uncertainty`; '' as above
    bands: np.ndarray | float = 0.0  # (K,) light of the systems whose rotational structure may err
    core: tuple | None = None
    depth: float = np.nan  # [1] optical depth of the strongest line, as simulated
    share: dict = field(default_factory=dict)
    given: tuple = ()  # effects of the condition that it holds, as terms

    @cached_property
    def base(self):
        """Spectrum of the condition (K,)."""
        return self.group.sum(axis=0)

    @cached_property
    def _by_power(self):
        return CubicSpline(self.log_power, np.log(self.radiance))

    def power_factor(self, change):
        r"""Spectrum at another power over that of the condition (K,), :math:`\ln P = \ln P_0 +` change.

        Between the powers simulated; of a single one, that of a hotter gas (`WARMTH_OF_POWER`), or only
        brighter if no such spectra are at hand.
        """
        if self.log_power.size < 2:
            if self.core is None:
                return np.exp(change) * np.ones(self.wavelength.size)
            warmth = np.clip(WARMTH_OF_POWER * change, *self.core[0][[0, -1]])
            return np.exp(self._hotter(warmth) - self._hotter(0.0))
        start = np.log(self.power)
        low, high = self.log_power[0] - 0.2, self.log_power[-1] + 0.2
        return np.exp(self._by_power(np.clip(start + change, low, high)) - self._by_power(start))

    @cached_property
    def continua(self):
        """Light of the simulated continua (K,), but for those among the `REST`."""
        return self.group[np.isin(self.group_name, CONTINUA)].sum(axis=0)

    def power_of_warmth(self, change):
        """Logarithm of the power ratio that a relative change of the gas temperature stands for."""
        return np.log1p(change) / WARMTH_OF_POWER

    def admitted(self, identity):
        """Least and largest amplitude of an effect that this gas could have; infinite where it says nothing:
        lines may be as much deeper as their optical depth may err, no continuum lacks that is not there."""
        if identity == "selfabs" and np.isfinite(self.depth):
            return 0.0, self.depth * np.expm1(BEYOND * DEPTH_ERROR)
        if identity == "contin":
            own = [name in CONTINUA or name == REST for name in self.group_name]
            return -100 * self.group[own].sum() / self.group.sum(), np.inf
        return -np.inf, np.inf

    def varies(self, name):
        """Whether the library holds what `factor` needs."""
        return self.core is not None if name in OF_CORE else name in self.variation

    def factor(self, name, amplitude, power=0.0):
        r"""Spectrum with one property varied over that without (K,), smooth in the amplitude.

        At another power than the simulated one the gas is hotter or colder by a factor :math:`1 + c`, the
        change of the temperature whose spectrum is most like that of the power:

        .. math:: \frac{L((1 + c)(1 + a))}{L(1 + c)}, \qquad
                  \frac{\langle L((1 + c)(1 + a\sin\omega t))\rangle}{L(1 + c)}

        for a hotter core and a ripple. What acts on some systems alone, excitation, vibration, depth, acts on
        their share :math:`w` of the light at that power, temperatures by :math:`a/T`:

        .. math:: 1 + \frac{w}{w_0} (f(a) - 1)

        A ripple of 0.15 doubles N2+ at the simulated power, and makes it three times as bright 13 % below.

        Parameters
        ----------
        name : 'core_temperature', 'ripple' or one of `variation`
        amplitude : float
        power : float
            Logarithm of the power over that of the condition.
        """
        at = self.warmth_of(power)
        if name == "core_temperature":
            return np.exp(self._hotter(at + (1 + at) * amplitude) - self._hotter(at))
        if name == "ripple":
            changed = self._hotter(at + (1 + at) * amplitude * RIPPLE)
            return np.mean(np.exp(changed - self._hotter(at)), axis=0)
        change = np.expm1(self._splines[name](amplitude / (1 + at) if name in BY_TEMPERATURE else amplitude))
        return np.maximum(1 + change * self._brighter_share(name, power), TINY)

    def _brighter_share(self, name, power):
        """Share of the light (K,) that a variation acts on, at a power over that at the simulated one."""
        if power == 0.0 or name not in self.share or self.log_power.size < 2:
            return 1.0
        here, there = (self._share_at(name, np.log(self.power) + more) for more in (0.0, power))
        return there / np.maximum(here, TINY)

    def _share_at(self, name, log_power):
        """Share of the light (K,) that a variation acts on: linear between the powers simulated."""
        above = int(np.clip(np.searchsorted(self.log_power, log_power), 1, self.log_power.size - 1))
        low, high = self.log_power[above - 1 : above + 1]
        part = np.clip((log_power - low) / (high - low), 0.0, 1.0)
        return (1 - part) * self.share[name][above - 1] + part * self.share[name][above]

    def hotter(self, change):
        """`core` about gas that is hotter by a relative change."""
        if self.core is None or change == 0.0:
            return self.core
        at = self.core[0]
        there = (1 + change) * (1 + at) - 1
        inside = (there >= at[0]) & (there <= at[-1])
        return at[inside], np.exp(self._hotter(there[inside]))

    def warmth_of(self, power):
        """Relative change of the temperature of the gas that a change of the power stands for."""
        return float(self._warmth(np.clip(power, -LARGEST_POWER, LARGEST_POWER)))

    @cached_property
    def _warmth(self):
        powers = np.linspace(-LARGEST_POWER, LARGEST_POWER, 17)
        if self.core is None or self.log_power.size < 2:
            return CubicSpline(powers, powers * (0.0 if self.core is None else WARMTH_OF_POWER))
        ends = self.core[0][[0, -1]] / 2
        tried = np.linspace(*ends, WARMTHS)
        shapes = self._hotter(tried)
        shapes = shapes - shapes.mean(axis=1, keepdims=True)
        found = []
        for power in powers:
            wanted = np.log(self.power_factor(power))
            cost = np.mean((wanted - wanted.mean() - shapes) ** 2, axis=1)
            place = int(np.clip(np.argmin(cost), 1, WARMTHS - 2))
            found.append(tried[place] + (tried[1] - tried[0]) * vertex(*cost[place - 1 : place + 2]))
        found = np.array(found)
        return CubicSpline(powers, found - found[powers.size // 2])

    @cached_property
    def _hotter(self):
        at, light = self.core
        return CubicSpline(at, np.log(light / self._at_zero(at, light)))

    @cached_property
    def _splines(self):
        return {
            name: CubicSpline(at, np.log(light / self._at_zero(at, light)))
            for name, (at, light) in self.variation.items()
        }

    @staticmethod
    def _at_zero(amplitude, light):
        return light[np.argmin(np.abs(amplitude))]


def vertex(left, middle, right):
    """Where the parabola through three equally spaced values is least, in steps from the middle one."""
    bend = left - 2 * middle + right
    return 0.5 * (left - right) / bend if bend > 0 else 0.0


def line_groups(wavelength, component, radiance):
    """Groups of lines whose strengths err independently: names (G,), and light (G, K) that adds up to the
    whole.

    Of the `radiance` (C, K) [W m-2 sr-1 m-1] of components. ASSUME: lines of one atom with less than 1 nm of
    darkness between them (a multiplet) share an error of strength, as do the faint lines of one atom, and the
    bands of N2 1P of one sequence.
    """
    names, rows = [], []
    whole = radiance.sum()
    rest = np.zeros(wavelength.size)
    for name, light in zip(component, radiance, strict=True):
        if name in ATOMS:
            faint = np.zeros(wavelength.size)
            for first, last in _clusters(wavelength, light):
                inside = (wavelength >= first) & (wavelength < last)
                if light[inside].sum() > SMALL * whole:
                    names.append(
                        f"{name} {1e9 * np.average(wavelength[inside], weights=light[inside]):.0f} nm"
                    )
                    rows.append(np.where(inside, light, 0.0))
                else:
                    faint = faint + np.where(inside, light, 0.0)
            if faint.any():
                names.append(f"faint lines of {name}")
                rows.append(faint)
        elif name == BANDS_OF:
            for first, last in zip(MOLECULAR_EDGES[:-1], MOLECULAR_EDGES[1:], strict=True):
                inside = (wavelength >= first) & (wavelength < last)
                names.append(f"{name} {first * 1e9:.0f}-{last * 1e9:.0f} nm")
                rows.append(np.where(inside, light, 0.0))
        elif light.sum() > SMALL * whole:
            names.append(name)
            rows.append(light)
        else:
            rest = rest + light
    return (*names, REST), np.array([*rows, rest])


def _clusters(wavelength, light):
    """Edges (first, last) of stretches of a spectrum, cut in the widest dark gaps between its lines."""
    bright = np.flatnonzero(light > 2e-3 * light.max())
    gaps = np.flatnonzero(np.diff(wavelength[bright]) > ATOMIC_GAP)
    cuts = [(wavelength[bright[g]] + wavelength[bright[g + 1]]) / 2 for g in gaps]
    edges = [wavelength[0], *cuts, wavelength[-1] * (1 + 1e-9)]
    return list(zip(edges[:-1], edges[1:], strict=True))


def widened(wavelength, radiance, extra_sigma):
    """Convolve spectra (..., K) on equal steps with a Gaussian of some standard deviation [m]."""
    if extra_sigma <= 0:
        return radiance
    frequency = np.fft.rfftfreq(wavelength.size, (wavelength[-1] - wavelength[0]) / (wavelength.size - 1))
    damping = np.exp(-2 * (np.pi * frequency * extra_sigma) ** 2)
    return np.fft.irfft(np.fft.rfft(radiance, axis=-1) * damping, wavelength.size, axis=-1)


def extra_sigma(fwhm, library_fwhm):
    """Standard deviation [m] that widens the slit of the library to another; 0 for a narrower one."""
    return np.sqrt(max(fwhm**2 - library_fwhm**2, 0.0)) / FWHM_PER_SIGMA
