"""The base model of a test on bins, with any effects of the catalogue added."""

from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from plasmapyro.diagnosis.effects.scene import Output, Scene
from plasmapyro.diagnosis.fit.observation import band_weights
from plasmapyro.radiation.planck import planck_and_slope
from plasmapyro.record.emittance import PER_MICRON, PIVOT, relative_emittance
from plasmapyro.record.inputs import has_plasma

FAINTEST = 0.3  # [1], of the mean light: what the error of a channel counts from where the gas is dark
TINY = 1e-6  # [1], of what it counts from: less light is none
WALK = "dark_walk"  # begin of the ids of the modes of a dark that wanders
TAIL = 1.05e-6, 1.13e-6  # [m] over which an error of the long-wave response grows
INITIAL_TEMPERATURE = 350.0  # [K]
INITIAL_UNCERTAINTY = 40.0  # [K]
ANY_TEMPERATURE = 1e4  # [K] of it where nothing is known of the start
POWER_SIGMA = 0.08  # [1] of ln P: the efficiency 0.375 +- 0.025 of the paper and the scatter of the field
CURVATURE = 20.0  # [K s-2] prior of the second derivative of the temperature just after the injection,
CURVATURE_OFF = 6.0  # [K s-2] and just after the end: T' = -35 K/s of a cooling surface bends by 4 T'^2/T
CURVATURE_TIME = 15.0  # [s] which falls off with this time
CURVATURE_FLOOR = 0.002  # [K s-2] to this
SLOW_TIMES, SLOW_HEIGHT = (40.0, 120.0, 400.0), 500.0  # [s], [K] besides, of a sample slow to its end
ROOT = 100.0  # [K s-1/2] besides, a quarter of T over the root of the time: 400 K in 1 s, as what loses
# 175 kW/m2 and has an effusivity of 500 W s1/2 m-2 K-1, between light ablators (300) and ceramics (5000),
ROOT_TIME = 60.0  # [s] until its back feels it,
SHORTEST = 0.2  # [s] from when on
BULGE = 2.0  # [K] of a knot over its neighbours: of a flux that does not end at once


class History:
    """Temperature of the surface as a spline through knots, with a break in slope when the plasma ends.

    Over the root of the time since the injection, and since the end: a thick sample follows a flux that sets
    in as this root, a thin one as its square, and a cubic holds both.
    """

    def __init__(self, knots, off, cold=True, bend=0.0):
        """`cold`: it starts cold at time 0 and heats as what is put into a plasma; else it may be any.

        `bend` (K,) [K s-2]: second derivatives at the knots that the light shows, beyond those of the prior.
        """
        self.bend = np.broadcast_to(bend, knots.shape)
        self.knots, self.off, self.cold = knots, off, cold
        self.before = knots <= off + 1e-9
        self.after = knots >= off - 1e-9

    def basis(self, time):
        """Weights (..., K) of the knots at the times (...); before injection those of the first knot."""
        time = np.asarray(time, dtype=float)
        weights = np.zeros((*time.shape, self.knots.size))
        early = time <= self.off
        for (chosen, spline), inside in zip(self._splines, (early, ~early), strict=True):
            if spline is not None and inside.any():
                own = self.knots[chosen]
                block = np.zeros((inside.sum(), self.knots.size))
                since = np.clip(time[inside], own[0], own[-1]) - own[0]
                block[:, chosen] = spline(np.sqrt(since))
                weights[inside] = block
        return weights

    @cached_property
    def _splines(self):
        """Cardinal splines of the knots before and after the end of the plasma."""
        splines = []
        for chosen in (self.before, self.after):
            own, count = self.knots[chosen], int(chosen.sum())
            first = "not-a-knot" if count > 3 else "natural"
            splines.append(
                None
                if count < 2
                else CubicSpline(np.sqrt(own - own[0]), np.eye(count), bc_type=(first, "natural"))
            )
        return list(zip((self.before, self.after), splines, strict=True))

    def roughness(self):
        r"""Rows (R, K) of second differences over their prior [1]: heating and cooling are smooth.

        While it heats, the second derivative is :math:`\sum_k c_k e^{-t/\tau_k}` besides, with the standard
        deviations :math:`H/\tau_k^2` of the c, `SLOW_HEIGHT` and `SLOW_TIMES`.
        """
        rows, slow = [], []
        for chosen, start in ((self.before, self.knots[0]), (self.after, self.off)):
            place = np.flatnonzero(chosen)
            for left, middle, right in zip(place[:-2], place[1:-1], place[2:], strict=True):
                a, b = np.diff(self.knots[[left, middle, right]])
                row = np.zeros(self.knots.size)
                row[[left, middle, right]] = 2 / (a * (a + b)), -2 / (a * b), 2 / (b * (a + b))
                own, besides = self._bending(self.knots[middle], start)
                own += self.bend[middle] * self.cold
                rows.append(row / own)
                slow.append(besides / own)
        if rows:  # the root of (1 + M M^T)^-1
            mode, size, _ = np.linalg.svd(np.array(slow), full_matrices=False)
            share = 1 - 1 / np.sqrt(1 + size**2)
            rows = rows - (mode * share) @ (mode.T @ np.array(rows))
        first = np.zeros(self.knots.size)
        first[0] = 1 / (INITIAL_UNCERTAINTY if self.cold else ANY_TEMPERATURE)
        return np.array([*rows, first])

    def _bending(self, time, start):
        """Prior standard deviations [K s-2] at times (...) of a phase: each anew, and (3, ...) that stay."""
        end = start != self.knots[0]
        since, none = np.asarray(time) - start, np.zeros((len(SLOW_TIMES), *np.shape(time)))
        if not self.cold:
            return np.full(np.shape(time), CURVATURE_OFF if end else CURVATURE), none
        root = ROOT * np.maximum(since, SHORTEST) ** -1.5 * np.exp(-since / ROOT_TIME)
        own = (CURVATURE_OFF if end else CURVATURE) * np.exp(-since / CURVATURE_TIME) + root + CURVATURE_FLOOR
        return own, none if end else np.array([SLOW_HEIGHT / t**2 * np.exp(-since / t) for t in SLOW_TIMES])

    def bending(self, time):
        """Prior standard deviation (...) [K s-2] of the second derivative at times (...), without `bend`."""
        parts = [
            np.hypot(own, np.linalg.norm(slow, axis=0))
            for own, slow in (
                self._bending(np.maximum(time, 0.0), self.knots[0]),
                self._bending(np.maximum(time, self.off), self.off),
            )
        ]
        return np.where(np.asarray(time) < self.off, *parts)

    def bulges(self):
        """Rows (R, K): by how much a knot after the end is above the chord of its neighbours, over `BULGE`.

        What nothing heats any more cools ever more slowly. Light that a jet scatters away falls as that of a
        colder surface does, at all wavelengths alike: this alone tells them apart, where the plasma ends.
        """
        place, rows = np.flatnonzero(self.after) if self.cold else (), []
        for left, middle, right in zip(place[:-2], place[1:-1], place[2:], strict=True):
            a, b = np.diff(self.knots[[left, middle, right]])
            row = np.zeros(self.knots.size)
            row[[left, middle, right]] = -b / (a + b), 1.0, -a / (a + b)
            rows.append(row / BULGE)
        return np.array(rows).reshape(-1, self.knots.size)


def knots(edges, injection, off, end, pauses=()):
    """Knots [s]: the injection, the middles of the bins after it, the end of the plasma, the last edge; none
    in pauses (n, 2) [s], in which nothing is seen."""
    middle = (edges[1:] + edges[:-1]) / 2
    last = edges[-1] if off < end else min(edges[-1], off)  # nothing tells of a cooling without samples
    own = middle[(middle > injection) & (np.abs(middle - off) > 0.2) & (middle < last)]
    ends = [injection, last] + ([off] if off < end else [])
    result = np.unique(np.concatenate([own, ends]))
    return result[[not any(first < one < last for first, last in pauses) for one in result]]


class Model:
    """Signals of all instruments by the knots of the temperature, parameters and effects."""

    def __init__(
        self,
        instruments,
        library,
        history,
        parameters,
        record,
        slope,
        response,
        lamp,
        persistent,
        given=(),
        precision=None,
        power=None,
    ):
        """`parameters` of the base model; `persistent` errors of each instrument, whose numbers follow.

        `precision` (V, V): inverse covariance of all of them before the data, if not independent; `power`:
        mean and standard deviation of the logarithm of the power of the gas over the simulated one.
        """
        self.instruments, self.library, self.history = instruments, library, history
        self.own, self.persistent, self.given, self.record = tuple(parameters), persistent, given, record
        self.parameters = (*parameters, *(one for errors in persistent for one in errors.parameters))
        sigma = np.array([one.sigma for one in self.parameters])
        self.precision = np.diag(sigma**-2.0) if precision is None else precision
        self.power = (0.0, POWER_SIGMA) if power is None else power
        self.off, self.emittance = record.off, record.emittance
        self.plasma = has_plasma(record.attributes)
        self.slope, self.response, self.lamp = slope, response, lamp
        # (M,) of each instrument, over the stated emittance; a number for a grey surface.
        self.relative = [
            relative_emittance(instrument.wavelength, slope) if slope else 1.0 for instrument in instruments
        ]
        self.bases = [history.basis(instrument.moment) for instrument in instruments]
        self.index = {parameter.id: place for place, parameter in enumerate(parameters)}
        ends = np.cumsum([len(parameters), *(len(errors.parameters) for errors in persistent)])
        self.places = [slice(*pair) for pair in zip(ends[:-1], ends[1:], strict=True)]
        self.errors = [
            errors.basis(instrument.time) for errors, instrument in zip(persistent, instruments, strict=True)
        ]
        self.walking = [place for name, place in self.index.items() if name.startswith(WALK)]
        self.wandering = [place for place, one in enumerate(self.own) if one.history]
        self.gas_histories = [self._gas_history(instrument.moment) for instrument in instruments]
        self._weights = {}
        self._glows = {}
        self._power = {}

    def _gas_history(self, moment):
        """Change (..., w) of the brightness of the gas at times (...) [s] per unit of what wanders."""
        rows = [np.interp(moment, *self.own[place].history) for place in self.wandering]
        return np.stack(rows, axis=-1) if rows else np.zeros((*moment.shape, 0))

    @property
    def size(self):
        """Number of knots."""
        return self.history.knots.size

    def value(self, values, name):
        """One of the parameters, 0 for one that this model does not have."""
        return values[self.index[name]] if name in self.index else 0.0

    def progress(self, which):
        """Share (n,) of the record that has gone by in the bins of an instrument, 0 to 1."""
        first, last = self.persistent[which].knots[[0, -1]]
        return np.clip((self.instruments[which].time - first) / (last - first), 0.0, 1.0)

    def _dark(self, values, progress):
        r"""Counts (n,) by which the dark of a spectrometer has drifted after a share (n,) of the record: a
        straight line and a Brownian bridge, :math:`\sum_k a_k \sin k\pi x`."""
        drift = self.value(values, "dark_drift") * progress
        for mode, place in enumerate(self.walking, 1):
            if values[place]:
                drift = drift + values[place] * np.sin(mode * np.pi * progress)
        return drift

    def settings_of_given(self, values):
        """Settings of the terms that are taken as given, with the numbers that the parameters hold."""
        return tuple(
            term.at({name: values[self.index[f"{term.setting.id}.{name}"]] for name in term.uncertainty})
            for term in self.given
        )

    def spectrum(self, values):
        """Spectrum (K,) of the gas after injection, as simulated."""
        power = float(self.value(values, "power"))
        if power not in self._power:
            self._power = {power: self.library.power_factor(power)} | dict(list(self._power.items())[-3:])
        return self.library.base * self._power[power] * np.exp(values[self.index["gas"]])

    def scene(self, which, temperatures, values, settings):
        """Scene of an instrument and, on the same shape, the slope of its black body."""
        instrument = self.instruments[which]
        late = float(self.value(values, "moments")) + sum(one.late(instrument.kind) for one in settings)
        if instrument.kind == "pyrometer":
            late += float(self.value(values, "clocks"))
        basis, temperature, body, slope = self._glow(which, late, temperatures)
        after, ended = (instrument.share_after(event, late) for event in (0.0, self.off))
        injected = after[..., None]
        before = np.exp(values[self.index["before_injection"]])
        gain = (1 - after) * before + after - ended
        gain = self.plasma * gain * np.exp(self.gas_histories[which] @ values[self.wandering])
        scene = Scene(
            kind=instrument.kind,
            time=instrument.moment,
            temperature=temperature,
            wavelength=instrument.wavelength,
            off_time=self.off,
            glow=body * injected,
            emittance=self._emittance(which, values),
            gas_gain=gain,
            spectral_axis=self.library.wavelength,
            spectrum=self.spectrum(values),
            library=self.library,
            power=float(self.value(values, "power")),
            more_gas=self._before(instrument, values, gain),
            response_shift=tuple(1e-9 * self.value(values, f"edge_{name}") for name in instrument.band),
            response_tail=self.value(values, "tail"),
            history=lambda moment: np.maximum(self.history.basis(moment) @ temperatures, 250.0),
        )
        return scene, slope * injected, basis

    def _emittance(self, which, values):
        """Emittance, a number or (M,) at the nodes of an instrument."""
        level = self.emittance * np.exp(values[self.index["emittance"]]) * self.relative[which]
        if "emittance_slope" in self.index:
            away = PER_MICRON * (self.instruments[which].wavelength - PIVOT)
            level = level * (1 + values[self.index["emittance_slope"]] * away)
        course = self.instruments[which].course
        if course is None:
            return level
        own = [values[self.index[f"course_{place}"]] for place in range(course.shape[1])]
        return level * self.instruments[which].relative * np.exp(course @ own)

    def _before(self, instrument, values, brightness):
        """What the gas before the injection shines more or less than the same gas, as if at another power."""
        change = float(self.value(values, "before_power"))
        if change == 0.0:
            return ()
        light = self.spectrum(values)
        factor = self.library.power_factor(change)
        share = np.where(instrument.moment < 0, brightness, 0.0)
        return ((share, light * (factor * (light.sum() / (light @ factor)) - 1)),)

    def _glow(self, which, late, temperatures):
        """Basis, temperature (n, 2), black body and its slope (n, 2, M) of an instrument whose samples are
        late [s]; the last two are kept: fits ask for one beside the other."""
        for kept in self._glows.get(which, ()):
            if kept[0] == late and np.array_equal(kept[1], temperatures):
                return kept[2]
        instrument = self.instruments[which]
        basis = self.history.basis(instrument.moment + late) if late else self.bases[which]
        temperature = np.maximum(basis @ temperatures, 250.0)
        found = (basis, temperature, *planck_and_slope(instrument.wavelength, temperature))
        self._glows[which] = ((late, temperatures.copy(), found), *self._glows.get(which, ())[:1])
        return found

    def changed_scene(self, which, temperatures, values, settings):
        """`scene` with what settings change of its light, and those that act on the instrument, in order."""
        settings = (*self.settings_of_given(values), *settings)
        mine = [setting for setting in settings if setting.acts_on(self.instruments[which].kind)]
        ordered = sorted(mine, key=lambda setting: setting.effect.order)
        scene, slope, basis = self.scene(which, temperatures, values, ordered)
        for setting in ordered:
            if setting.effect.light is not None:
                scene = setting.effect.light(scene, setting.amplitude, **setting.shape)
        return scene, slope, basis, ordered

    def evaluate(
        self, which, temperatures, values, settings=(), *, slopes=False, gas_error=0.0, level_error=None
    ):
        """Values (n, C) of an instrument; with `slopes` also their derivative by the knots (n, C, K).

        Faults that count in units of the gas may have theirs at another error `level_error`: as it is.
        """
        instrument = self.instruments[which]
        scene, slope, basis, ordered = self.changed_scene(which, temperatures, values, settings)
        gas = self._gas(instrument, scene, gas_error)
        light = scene.path * (scene.emittance * scene.glow + gas + scene.added)
        weight = self._channel_weight(instrument, scene)
        time, channel = self.errors[which]
        gain = self._gain(which, values) * np.exp((time * values[self.places[which]]) @ channel.T)
        value = gain * self._channels(light.mean(axis=1), weight)
        detecting = [setting for setting in ordered if setting.effect.output is not None]
        if detecting:
            level = gas if level_error is None else self._gas(instrument, scene, level_error)
            output = Output(
                instrument.kind,
                instrument.time,
                self.off,
                value,
                instrument.factor,
                self._gas_level(instrument, scene, level, weight, gain),
                np.nanmax(instrument.value, axis=0) if instrument.highest is None else instrument.highest,
                instrument.pixels,
                instrument.wavelength,
            )
            for setting in detecting:
                output = output.but(setting.effect.output(output, setting.amplitude, **setting.shape))
            value = output.value
        if instrument.kind == "spectrometer":
            value = value + self._dark(values, self.progress(which))[:, None] * instrument.factor
        if not slopes:
            return value
        by_knot = scene.path * scene.emittance * slope
        by_knot = np.broadcast_to(by_knot, scene.glow.shape) / scene.glow.shape[1]
        by_knot = gain[:, None] * self._channels(by_knot, weight)
        return value, np.matmul(by_knot.transpose(0, 2, 1), basis)

    def persistent_columns(self, which, value):
        """Change (n, C, m) of values (n, C) of an instrument per unit of each of its persistent errors."""
        time, channel = self.errors[which]
        return value[..., None] * time[:, None] * channel

    def _gas(self, instrument, scene, error=0.0):
        """Light of the gas (n, 2, M), with an error (C,) of each channel over its simulated light; of two
        rows (2, C) the second multiplies what is seen before the injection."""
        spectra = [scene.spectrum, *(row for _, row in (*scene.scattered, *scene.more_gas))]
        nodes = self._on_nodes(instrument, np.array(spectra), scene)
        before = 0.0
        if np.any(error):
            rows = np.atleast_2d(error)
            error = np.broadcast_to(rows, (len(rows), instrument.channels))
            if instrument.weight is not None:
                error = np.repeat(error, [edges.size - 1 for edges in instrument.node_edges], axis=1)
                level = nodes[0]
            else:
                level = np.maximum(nodes[0], FAINTEST * nodes[0].mean())
            light = nodes[0] + error[0] * level
            least = np.maximum(nodes[0], TINY * level)  # 0 beside the edges of a band
            nodes[1 : 1 + len(scene.scattered)] *= light / np.where(least > 0, least, np.inf)
            nodes[0] = light
            before = error[1:].sum(axis=0)
        gas = scene.gas_gain[..., None] * nodes[0]
        for (share, _), row in zip((*scene.scattered, *scene.more_gas), nodes[1:], strict=True):
            gas = gas + share[..., None] * row
        if np.any(before):
            gas = gas * np.where((instrument.moment < 0)[..., None], 1 + before, 1.0)
        return gas

    def _on_nodes(self, instrument, spectra, scene):
        if scene and instrument.kind == "spectrometer" and (scene.wavelength_shift or scene.slit_sigma2):
            spectra = moved(self.library.wavelength, spectra, scene.wavelength_shift, scene.slit_sigma2)
        return (instrument.gas_map @ spectra.T).T

    def _channel_weight(self, instrument, scene):
        if instrument.weight is None:
            return None
        key = (*scene.response_shift, *scene.detector_shift, scene.response_tail)
        if not any(key):
            return instrument.weight
        if key not in self._weights:
            self._weights = {key: self._other_response(instrument, scene)}
        return self._weights[key]

    def _other_response(self, instrument, scene):
        """Weights (C, M) of responses moved along the wavelength or with another tail."""
        wavelength, responses = self.response
        weight, first = instrument.weight.copy(), 0
        tail = 1 + scene.response_tail * np.clip((wavelength - TAIL[0]) / (TAIL[1] - TAIL[0]), 0, 1)
        for band, (row, edges) in enumerate(zip(responses, instrument.node_edges, strict=True)):
            part, shift = slice(first, first + edges.size - 1), scene.response_shift[band]
            plain = band_weights(edges, wavelength, row)
            if any(scene.detector_shift[band : band + 1]):
                row = _parted(wavelength, row, scene.detector_shift[band])
            other = band_weights(edges, wavelength + shift, row * tail)
            # The nodes of the gas hold means over the unchanged response: change by what the change does.
            weight[band, part] = instrument.weight[band, part] + (other - plain)
            first = part.stop
        return weight

    @staticmethod
    def _channels(light, weight):
        return light if weight is None else light @ weight.T

    def _gain(self, which, values):
        """From the light of the nodes to the unit of the values (C,)."""
        instrument = self.instruments[which]
        logarithm = self.value(values, f"gain_{instrument.kind}")
        if instrument.kind == "pyrometer":
            logarithm = logarithm + np.append(self.value(values, "ratio"), np.zeros(instrument.channels - 1))
            for place, parameter in enumerate(self.own):
                if parameter.calibrated:
                    logarithm = logarithm - values[place] * np.array(parameter.calibrated)
        return (
            instrument.gain
            * np.exp(logarithm)
            * (1 - self.value(values, "lamp") * self.lamp[instrument.kind])
        )

    def signal_of(self, which, spectra, values, scene=None):
        """Signals (..., C) of an instrument for spectra (..., K) on the axis of the library, by its scale and
        slit in a scene."""
        instrument = self.instruments[which]
        nodes = self._on_nodes(instrument, np.atleast_2d(spectra), scene)
        nodes = nodes.reshape(*np.shape(spectra)[:-1], -1)
        return self._gain(which, values) * self._channels(nodes, instrument.weight)

    def gas_level(self, which):
        """Level (C,) that the errors of the gas of an instrument count from, and its simulated light (C,)."""
        light = self.signal_of(which, self.library.base, np.array([one.centre for one in self.parameters]))
        if self.instruments[which].weight is not None:
            return light, light
        return np.maximum(light, FAINTEST * light.mean()), light

    def _gas_level(self, instrument, scene, gas, weight, gain):
        """Signal (C,) of the gas (n, 2, M) after the injection, mean while it shines; simulated if never."""
        share = scene.injected * scene.plasma * (scene.gas_gain > 0)
        if np.any(share):
            light = np.tensordot(share / share.sum(), gas)
        else:
            light = self._on_nodes(instrument, scene.spectrum[None], scene)[0]
        return gain.mean(axis=0) * self._channels(light, weight)


def moved(axis, spectra, shift, sigma2):
    """Spectra (..., K) on equal steps, seen at a shifted wavelength and through a slit of more variance.

    A negative `sigma2` sharpens; used for small ones only.
    """
    frequency = np.fft.rfftfreq(axis.size, (axis[-1] - axis[0]) / (axis.size - 1))
    turn = 2j * np.pi * frequency
    change = np.exp(turn * shift - 2 * (np.pi * frequency) ** 2 * sigma2)
    return np.fft.irfft(np.fft.rfft(spectra, axis=-1) * change, axis.size, axis=-1)


def _parted(wavelength, response, shift):
    """A response whose fall beyond its peak, the detector's, is moved by `shift` [m]; what lets its
    short-wave flank rise, a filter, stays."""
    peak = int(np.argmax(response))
    top = response[peak]
    flank = np.where(np.arange(response.size) < peak, response, top)
    fall = np.where(np.arange(response.size) < peak, top, response)
    return flank * np.interp(wavelength - shift, wavelength, fall) / top
