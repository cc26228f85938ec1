"""Signals of the surface alone: what the gas gave in the reference window, taken away."""

import numpy as np

from plasmapyro.checks import increasing

LEAST_SAMPLES = 3  # of a reference window
CHANCE = 3.0  # standard errors of a covariance


def reference_signal(time, signal, window):
    r"""Mean signal of the reference window (both ends included) and its standard uncertainty, floats [A].

    .. math:: u^2 = \frac{s^2}{n_e}, \qquad n_e = \max\left(1, n\,\frac{1 - r_1}{1 + r_1}\right)

    with the scatter s of the n samples, NaN where missing, and their lag-one correlation r_1 (>= 0): flicker
    of the plasma lasts longer than a sample. ValueError if fewer than three samples lie in the window.

    Source: Fagnani et al., eq. 12. Deviation: the uncertainty of the mean is carried along.

    >>> time, signal = np.arange(5.0), np.array([9.0, 3.0, 5.0, 4.0, 8.0])
    >>> mean, uncertainty = reference_signal(time, signal, (1.0, 3.0))
    >>> mean, round(uncertainty, 3)
    (4.0, 0.577)
    """
    time = increasing("time", time, "s")
    inside = (time >= window[0]) & (time <= window[1]) & np.isfinite(signal)
    if inside.sum() < LEAST_SAMPLES:
        raise ValueError(
            f"the reference window {window[0]:g} to {window[1]:g} s holds {inside.sum()} samples,"
            f" {LEAST_SAMPLES} needed"
        )
    samples = np.asarray(signal, dtype=float)[inside]
    rest = samples - samples.mean()
    power = np.sum(rest**2)
    memory = np.clip(np.sum(rest[1:] * rest[:-1]) / power, 0.0, 1.0) if power > 0 else 0.0
    effective = max(1.0, samples.size * (1 - memory) / (1 + memory))
    return float(samples.mean()), float(np.sqrt(power / (samples.size - 1) / effective))


def shared_scatter(time, pair, window):
    """Relative scatter that both signals (2, t) show in the reference window; 0 if it is chance."""
    inside = (time >= window[0]) & (time <= window[1]) & np.isfinite(pair).all(axis=0)
    seen = pair[:, inside]
    if inside.sum() < LEAST_SAMPLES or not (seen.mean(axis=1) > 0).all():
        return 0.0
    (wide, common), (_, narrow) = np.cov(seen / seen.mean(axis=1, keepdims=True))
    return float(np.sqrt(common)) if common > CHANCE * np.sqrt(wide * narrow / inside.sum()) else 0.0


def corrected_signal(signal, reference, injected, shining):
    r"""Signal (..., t) of the surface; NaN before injection: there is no surface in view.

    .. math:: S^{corr} = S - S^{ref} \;\text{(plasma on)}, \qquad S \;\text{(plasma off)}

    `injected` and `shining` (t,) come from `phases`; the reference (...) broadcasts over time.

    Source: Fagnani et al., eq. 13 (signals) and eq. 14 (spectra). ASSUME: the gas radiance of the reference
    window holds until the plasma is switched off.

    Before the injection, in the plasma, after it is switched off:

    >>> injected, shining = np.array([False, True, True]), np.array([True, True, False])
    >>> corrected_signal([5.0, 7.0, 7.0], 4.0, injected, shining)
    array([nan,  3.,  7.])
    """
    reduced = np.asarray(signal, dtype=float) - np.where(shining, np.asarray(reference)[..., None], 0.0)
    return np.where(injected, reduced, np.nan)


def corrected_signal_uncertainty(
    signal, reference, reference_uncertainty, shining, signal_uncertainty, gas_variation
):
    r"""Standard uncertainty (..., t) of the corrected signal (..., t).

    .. math:: u^2 = (u_S S)^2 + u_{ref}^2 + (v S^{ref})^2

    the last two only while the plasma is on. u_S, `signal_uncertainty` [1], is that of one signal, relative;
    v, `gas_variation` [1], the relative standard deviation of the gas radiance about that of the reference
    window. Deviation: the paper assumes v = 0.
    """
    gas = np.asarray(reference_uncertainty) ** 2 + (gas_variation * np.asarray(reference)) ** 2
    return np.sqrt((signal_uncertainty * np.asarray(signal)) ** 2 + np.where(shining, gas[..., None], 0.0))
