"""How large an effect is in standard deviations of a test of the second laboratory, the gas left free."""

import numpy as np

from worlds.engine import CENTRES
from worlds.faults import EFFECTS
from worlds.laboratory import (
    APART,
    DRIFT,
    SMOOTH,
    TOGETHER,
    dark_noise,
    gains,
    lamp_noise,
    onto_smooth,
    planck,
    scale,
    sensitivity,
    through_slit,
    wander_of,
)

FREE = 0.3  # relative prior of the light of the gas in every pixel and band, before and after injection apart
STRENGTHS = (0.09, 0.05, 0.1, 0.3, 0.3, 0.2)  # of the components, where an effect acts on the gas alone
WINDOW, LOCAL = 25e-9, 0.05  # further free factors of the simulated gas: by window of wavelength
FRAMES, PIXELS, READINGS = 160, 220, 400
FAINT = 1e-3  # of the light of the gas: strengths of less are not told apart
# Scale of a spectrometer [m] and its stretch: 0.02 nm/K of a bench of aluminium (makers' data sheets).
# ASSUME: a kelvin between line lamp and test. Its slit: of two stated digits the last is uncertain by 0.29
# (JCGM 100:2008, F.2.2.1).
SCALE, DIGIT = 0.02e-9, 0.29
# [s] between two computers' clocks: "low tens of milliseconds" over wide networks (RFC 5905, 2010)
CLOCKS = 0.02
TILT = 0.03  # [um-1] of the emittance: 0.005 of its ratio between the bands


class Measure:
    r"""Whitened tests of one case with what any analysis must leave free projected out.

    Free are the temperature (hats over `knots`), emittance, gains and their wandering by its own law, the
    lamp, the shape of the spectral calibration, its noise and that of the dark in each pixel, edges of the
    bands, the clock of the pyrometer, brightness in each frame, and the gas: for effects of surface, path and
    instruments its light in each pixel and band, for those of the gas itself the strengths of its components,
    multiplets, progressions and continua, windows of wavelength, the power, the scale of the spectrometer and
    its slit. SNR is the length of what is left,
    :math:`\sqrt{e^T (I - N(N^TN+1)^{-1}N^T) e}`.
    """

    def __init__(self, stage):
        self.stage, self.lab, self.record = stage, stage.lab, stage.record
        self.every = max(1, self.record.instants.size // READINGS)
        self.instants = self.record.instants[self.every // 2 :: self.every]
        self.merge = max(1, self.record.middles.size // FRAMES), max(1, self.lab.pixels // PIXELS)
        self.reference = self.output(stage.scene)
        scene = stage.scene
        dark = scene.copy(surface={one: 0 * light for one, light in scene.surface.items()})
        self.gas = self.output(dark)
        middles = self._merged(self.record.middles[:, None], pixels=False)[:, 0]
        self.times = (
            self.instants if self.lab.has_pyrometer else self.instants[:0],
            middles if self.lab.has_spectrometer else middles[:0],
        )
        self.sigma = self._sigma()
        self.kept, self.kept_pixels = {}, {}

    def output(self, scene):
        """Signals (2, t) and count rates (frames, pixels), merged."""
        return [
            self.record.signals(scene, self.instants) if self.lab.has_pyrometer else np.zeros((2, 0)),
            self._merged(self.record.rates(scene)) if self.lab.has_spectrometer else np.zeros((0, 1)),
        ]

    def _merged(self, rows, pixels=True):
        frames, wide = self.merge
        count = rows.shape[0] // frames
        rows = rows[: count * frames].reshape(count, frames, -1).mean(axis=1)
        if not pixels:
            return rows
        columns = rows.shape[1] // wide
        return rows[:, : columns * wide].reshape(count, columns, wide).mean(axis=2)

    def _sigma(self):
        lab, (signals, rates) = self.lab, self.reference
        span = self.every / lab.pyrometer_rate
        steady = lab.pointing**2 * min(1.0, 1.4 / span)
        flicker = (self.stage.base.flicker * self.gas[0]) ** 2 * min(1.0, 2.0 / span)
        step = 2 * signals.max(initial=0) / 2**lab.bits
        first = np.sqrt(
            signals**2 * (lab.noise**2 / self.every + steady + lab.gain_flicker**2)
            + flicker
            + step**2 / (4 * self.every)
        )
        number = self.merge[0] * self.merge[1]
        counts = (
            np.maximum(rates * lab.exposure, 0) / lab.electrons
            + lab.read_noise**2
            + 30 * lab.exposure / lab.electrons
        )
        return np.maximum(first, 1e-30), np.sqrt(counts / number) / lab.exposure

    def _pixels(self, gas):
        """What is free in each pixel of the usable frames, whitened (frames, pixels, k): rows `r` lose
        `p @ (p.T @ r)`."""
        if gas not in self.kept_pixels:
            usable, (_, rates) = self._usable(self.times[1]), self.reference
            lamp, dark = self._of_mean(lamp_noise(self.lab)), self._of_mean(dark_noise(self.lab))
            free = [lamp * rates, dark / self.lab.exposure + 0 * rates]
            if not gas:
                early = (self.times[1] < 0)[:, None]
                free += [FREE * self.gas[1] * early, FREE * self.gas[1] * ~early]
            patterns = np.stack([(one / self.sigma[1])[usable] for one in free], axis=2)
            size, axes = np.linalg.eigh(np.einsum("fpk,fpl->pkl", patterns, patterns))
            size = np.maximum(size, 1e-12)
            share = np.sqrt((1 - 1 / np.sqrt(1 + size)) / size)
            self.kept_pixels[gas] = np.einsum("fpk,pkl,pl->fpl", patterns, axes, share)
        return self.kept_pixels[gas]

    def _of_mean(self, noise):
        """Standard deviations of the means over merged pixels."""
        wide = self.merge[1]
        columns = noise[: noise.size // wide * wide].reshape(-1, wide)
        return np.sqrt((columns**2).mean(axis=1) / wide)

    def _usable(self, time):
        edge = self.lab.exposure
        return (np.abs(time) > max(0.4, edge)) & (np.abs(time - self.stage.base.off) > max(0.7, edge))

    def flat(self, change, gas):
        """One whitened vector of changes of both instruments, brightness of frames and the free gas
        projected out."""
        vectors = []
        for index, (new, sigma) in enumerate(zip(change, self.sigma, strict=True)):
            if not new.size:
                continue
            usable = self._usable(self.times[index])
            rows = new if index else new.T  # (times, bands or pixels)
            noise = (sigma if index else sigma.T)[usable]
            rows = rows[usable] / noise
            light = (self.gas[index] if index else self.gas[index].T)[usable] / noise
            if index:
                whole = self.reference[1][usable] / noise
                rows = _without(rows, whole, self.lab.pointing, 1)
                slope = np.gradient(self.reference[1], self.times[1], axis=0)[usable] / noise
                rows = _without(rows, slope, self.lab.frame_jitter / np.sqrt(self.merge[0]), 1)
                rows = _without(rows, light, self.stage.base.flicker, 1)
                free = self._pixels(gas)
                rows = rows - np.einsum("fpk,pk->fp", free, np.einsum("fpk,fp->pk", free, rows))
            elif not gas:
                early = (self.times[index][usable] < 0)[:, None]
                rows = _without(_without(rows, light * early, FREE, 0), light * ~early, FREE, 0)
            vectors.append(rows.ravel())
        return np.concatenate(vectors)

    def nuisance(self, gas):
        """Rows (K, D) of one prior standard deviation each, and the Cholesky factor of their Gram matrix
        plus one."""
        if gas not in self.kept:
            rows = np.array([self.flat(row, gas) for row in self._rows(gas)])
            self.kept[gas] = rows, np.linalg.cholesky(rows @ rows.T + np.eye(len(rows)))
        return self.kept[gas]

    def _rows(self, gas):
        stage, (signals, rates) = self.stage, self.reference
        surface = [whole - light for whole, light in zip(self.reference, self.gas, strict=True)]
        warm = self._warmer()
        knots = np.concatenate(
            [
                [0, 0.7, 1.5, 3, 5, 8, 12, 17, 24, 33, 45],
                np.arange(60.0, stage.base.off - 5, 12.0),
                stage.base.off + np.array([0, 0.5, 1.5, 3, 6, 11, 20, 35, 60]),
            ]
        )
        for hat in np.eye(knots.size):
            first, second = (np.interp(time, knots, hat) * (time >= 0) for time in self.times)
            yield [200 * warm[0] * first, 200 * warm[1] * second[:, None]]
        for size, one, two in ((0.05, surface[0], surface[1]), (0.03, signals, 0), (0.03, 0, rates)):
            yield [size * one + 0 * signals, size * two + 0 * rates]
        yield [0.01 * signals * [[1.0], [-1.0]], 0 * rates]
        pixels = np.linspace(0, 1, rates.shape[1])
        for order in range(1, 9):
            yield [
                0 * signals,
                1.5 * self.lab.spectral_error / order * rates * np.cos(np.pi * order * pixels),
            ]
        wander, (first, second) = self.lab.wander, self.times
        for course in wander_of(first, TOGETHER).T if first.size else ():
            yield [wander[1] * signals * course, 0 * rates]
        for course in wander_of(first, APART).T if first.size else ():
            yield [wander[2] * signals * course * [[0.5], [-0.5]], 0 * rates]
        for course in wander_of(second, DRIFT).T if second.size else ():
            yield [0 * signals, wander[0] * rates * course[:, None]]
        if signals.size:
            yield [CLOCKS * np.gradient(signals, first, axis=1), 0 * rates]
        for name, size in (("edge1", 0.7), ("edge2", 0.7), ("resp_long", 0.015), ("eps_slope", TILT)):
            yield self._difference(EFFECTS[name].apply(stage.scene, size, {}, stage.context))
        if not gas:
            return
        early = stage.scene.time < 0
        base = stage.components.sum(axis=0)
        changes = [size * light for size, light in zip(STRENGTHS, stage.components, strict=True)]
        changes += [stage.variant("P_eff", 0.05) - base, FREE * base]
        changes += list(stage.strengths(FAINT))
        changes += [
            LOCAL * base * np.clip(1 - np.abs(CENTRES - at) / WINDOW, 0, 1)
            for at in np.arange(680e-9, 1200e-9, WINDOW)
        ]
        for change in changes:
            yield self._glow(change)
        yield self._glow(FREE * base, early)
        for pixels in self._of_scale(base):
            yield self._glow(0 * base, pixels=pixels)

    def _glow(self, light, when=1.0, pixels=None):
        """Outputs of more light (bins,), or of light in the pixels, with the history of the gas."""
        scene, lab, record = self.stage.scene, self.lab, self.record
        history, parts = scene.gas[0][1] * when, [np.zeros((2, 0)), np.zeros((0, 1))]
        if lab.has_pyrometer:
            seen = onto_smooth(light * scene.fine) * scene.path["p"][0]
            strength = scene.bands @ seen * (SMOOTH[1] - SMOOTH[0]) * gains(lab)
            parts[0] = strength[:, None] * np.interp(self.instants, scene.time, history)
        if lab.has_spectrometer:
            at = lab.wavelength
            seen = through_slit(light * scene.fine, at, lab.fwhm) if pixels is None else pixels
            seen = seen * np.interp(at, SMOOTH, scene.path["s"][0]) * sensitivity(lab) * scale(lab)
            parts[1] = self._merged(record.mean(scene.time, history[:, None]) * seen)
        return parts

    def _of_scale(self, light):
        """What the pixels see more where the scale is moved, stretched, and the slit wider, by a standard
        deviation each."""
        at, fwhm = self.lab.wavelength, self.lab.fwhm
        light, across = light * self.stage.scene.fine, np.linspace(-1, 1, at.size)
        plain = through_slit(light, at, fwhm)
        yield through_slit(light, at + SCALE, fwhm) - plain
        yield through_slit(light, at + SCALE * across, fwhm) - plain
        yield through_slit(light, at, fwhm + slit_error(fwhm)) - plain

    def _difference(self, scene):
        return [new - old for new, old in zip(self.output(scene), self.reference, strict=True)]

    def _warmer(self):
        """Change of both outputs per kelvin of the surface."""
        scene, body = self.stage.scene, self.stage.scene.emittance
        kelvin = scene.kelvin[:, None]
        more = body * (planck(SMOOTH, kelvin + 1) - planck(SMOOTH, kelvin)) * scene.seen[:, None]
        return self._difference(
            scene.copy(surface={one: light + more for one, light in scene.surface.items()})
        )

    def signature(self, effects, gas=None):
        """Whitened signature of effects with all that is free projected out, and its length."""
        gas = all(EFFECTS[one["effect"]].gas for one in effects) if gas is None else gas
        rows, root = self.nuisance(gas)
        vector = self.flat(self._difference(self.stage.hidden(effects)), gas)
        share = np.linalg.solve(root.T, np.linalg.solve(root, rows @ vector))
        left = within_stated(np.concatenate([vector - share @ rows, share]), effects, self.lab.fwhm)
        return left, float(np.sqrt(left @ left))

    def angle(self, one, other, known):
        """Degrees between the signatures of two effects; 90 if one is unknown here or invisible."""
        if one not in EFFECTS or other not in EFFECTS:
            return 90.0
        gas = EFFECTS[one].gas and EFFECTS[other].gas
        sides = []
        for name in (one, other):
            shape = {key: sum(limits) / 2 for key, limits in EFFECTS[name].shape.items()}
            plain = {"effect": name, "amplitude": 0.5 * EFFECTS[name].unit, "shape": shape}
            sides.append(self.signature([known.get(name, plain)], gas))
        (a, long), (b, short) = sides
        return (
            90.0
            if min(long, short) == 0
            else float(np.degrees(np.arccos(np.clip(abs(a @ b) / (long * short), 0, 1))))
        )

    def sized(self, name, snr, sign, shape):
        """The effect with the amplitude that gives an SNR, None where its range ends before."""
        entry = EFFECTS[name]
        amplitude, power, before = sign * entry.unit * 0.3, 1.0, None
        for _ in range(6):
            amplitude = float(np.clip(amplitude, entry.low, entry.high))
            _, size = self.signature([{"effect": name, "amplitude": amplitude, "shape": shape}])
            if size == 0:
                return None
            if before is not None and amplitude != before[0]:
                power = float(np.clip(np.log(size / before[1]) / np.log(amplitude / before[0]), 0.4, 3.0))
            before, wanted = (amplitude, size), amplitude * (snr / size) ** (1 / power)
            if abs(wanted / amplitude - 1) < 0.03:
                break
            amplitude = wanted
        if not entry.low <= amplitude <= entry.high:
            return None
        return {"effect": name, "amplitude": amplitude, "shape": shape, "snr": snr}


def within_stated(vector, effects, fwhm):
    """A signature, no longer than the steps of its stated error where a scale is off or a slit [m] wider.

    Rows are tangents: of a shift of a third of the slit they leave what a moved scale explains.
    """
    (one, *more), most = effects, np.inf
    if one["effect"] == "wshift" and not more:
        most = abs(one["amplitude"]) * 1e-9 / SCALE
    elif one["effect"] == "lsf" and not more:
        most = (np.hypot(fwhm, 2.3548e-9 * one["amplitude"]) - fwhm) / slit_error(fwhm)
    return vector * min(1.0, most / max(np.linalg.norm(vector), 1e-30))


def slit_error(fwhm):
    """Standard deviation of a width of two stated digits."""
    return DIGIT * 10.0 ** (np.floor(np.log10(fwhm) + 1e-9) - 1)


def _without(rows, pattern, prior, axis):
    """Rows with what a multiple of `pattern` along `axis`, of some prior, can explain taken out."""
    size = (pattern**2).sum(axis=axis, keepdims=True)
    along = (rows * pattern).sum(axis=axis, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(size > 0, (1 - 1 / np.sqrt(1 + size * prior**2)) / size, 0.0)
    return rows - pattern * along * share
