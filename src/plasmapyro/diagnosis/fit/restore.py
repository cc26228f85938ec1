"""A test as it would be without the effects that are taken as given: what a correction can start from."""

from dataclasses import replace

import numpy as np

from plasmapyro.diagnosis.fit import observation
from plasmapyro.diagnosis.fit.build import UNIFORM, of_given
from plasmapyro.diagnosis.fit.model import Model
from plasmapyro.diagnosis.fit.whole import fit_test
from plasmapyro.record import flags

BLOCK = 2000  # samples that are modelled at once
UNSEEN = 1e-4  # [1], rms of signals and spectra: a hundredth of what moves the ratio by 30 K
MOST = 10.0  # [1]: a sample that effects change by more tells nothing of what it was without them


def without_given(test, *inputs, **settings):
    """A test without the effects that are taken as given, and how uncertain that is.

    Parameters
    ----------
    test, *inputs, **settings : as of `fit_test`, which is called once

    Returns
    -------
    made : function (parameters moved {name: value}, none by default) -> Dataset, contract 'test'
    moves : list of such parameters
        One standard error each, independent of the others, the one that changes the data most first; those
        that change them by less than `UNSEEN` are left out.

    Notes
    -----
    Source: principal components of the change of the data, for the covariance of the numbers after the fit.
    """
    base = fit_test(test, *inputs, **settings)
    model, solution = base.model, base.solution
    names = [one.id for one in of_given(model.given)]
    places = [model.index[name] for name in names]
    fitted, own = solution.state.values[places], model.size + np.array(places, dtype=int)

    def made(moved=None):
        return restored(test, model.record, base, moved)

    def moves(columns):
        return [dict(zip(names, fitted + column, strict=True)) for column in columns.T]

    if not names:
        return made, []
    root = np.linalg.cholesky(solution.covariance[np.ix_(own, own)])
    plain = made()
    kinds = "signal_wide", "signal_narrow", "radiometer_signal", "spectral_radiance"
    seen = [name for name in kinds if name in plain]
    change = np.array(
        [
            np.concatenate([np.ravel(moved[name] / plain[name]) for name in seen]) - 1
            for moved in map(made, moves(root))
        ]
    )
    power, axes = np.linalg.eigh(np.nan_to_num(change) @ np.nan_to_num(change).T / change.shape[1])
    kept = np.flatnonzero(power > UNSEEN**2)[::-1]
    return made, moves(root @ axes[:, kept])


def restored(test, record, base, moved=None):
    r"""Signals and spectra of a test with the given effects of its base fit taken out.

    .. math:: y'(t + \tau) = y(t)\,\frac{M_\tau(x)}{M_a(x)}

    with the model at the fitted temperature and gas x, with the effects (a) and with those of clocks alone,
    whose shift :math:`\tau` moves the times: to divide by what moves would bend each jump.

    Parameters
    ----------
    test : Dataset, contract 'test'
    record : Record of it, every instrument calibrated
    base : Base, of a model with given terms
    moved : mapping parameter -> value, optional
        Numbers of the given terms other than fitted, as 'winE.amplitude'.

    Returns
    -------
    Dataset, contract 'test'
        Spectra as radiances; NaN where effects leave less than a tenth, or more than ten times.

    Notes
    -----
    ASSUME: between the pixels of a bin the change is linear in the wavelength.
    """
    model, result = base.model, test.copy()
    fitted = base.solution.state.values
    values, settings = fitted.copy(), model.settings_of_given(fitted)
    for name, value in (moved or {}).items():
        values[model.index[name]] = value
    for which, one in enumerate(model.instruments):
        data = record.instrument(one.source)
        late = sum(setting.late(one.kind) for setting in settings)
        half = data.integration_time / 2
        moment = data.time[:, None] + half / UNIFORM * observation.nodes_of(data.integration_time)
        change = _change(base, which, moment, values)
        if one.source == "radiometer":
            value = data.value.copy()
            value[:, [data.band.index(band) for band in one.band]] /= change
            result = result.drop_vars(["radiometer_reading", "radiometer_setting"], errors="ignore")
            result["radiometer_signal"] = ("radiometer_time", "band"), value, {"units": "1"}
            result = result.assign_coords(radiometer_time=result["radiometer_time"] + late)
            continue
        if one.kind == "pyrometer":
            for place, band in enumerate(data.band):
                name = f"signal_{band}"
                result[name] = test[name] / change[:, place]
            result = result.assign_coords(time=result["time"] + late)
            continue
        order = np.argsort(one.wavelength)
        pixels = np.array(
            [np.interp(data.wavelength, one.wavelength[order], row) for row in change[:, order]]
        )
        across = ("spectrum_time", "wavelength")
        result = result.drop_vars(["counts", "background_counts", "saturated"], errors="ignore")
        result = result.assign_coords(spectrum_time=result["spectrum_time"] + late)
        result["spectral_radiance"] = across, data.value / pixels, {"units": "W m-2 sr-1 m-1"}
        result["saturated"] = across, data.flagged(flags.SATURATED).astype("int8"), {"units": "1"}
    return result


def _change(base, which, moment, values):
    """Signals (t, C) of an instrument at instants (t, q) with the given effects over those with its clock."""
    model, state = base.model, base.solution.state
    given = [(model.given, values), ([one for one in model.given if one.setting.effect.clock], state.values)]
    found = []
    for first in range(0, len(moment), BLOCK):
        one = replace(model.instruments[which], moment=moment[first : first + BLOCK])
        rest = model.library, model.history, model.own, model.record, model.slope, model.response, model.lamp
        both = [
            Model([one], *rest, [model.persistent[which]], terms).evaluate(
                0,
                state.knots,
                np.concatenate([numbers[: len(model.own)], numbers[model.places[which]]]),
                gas_error=state.error_of_gas(which),
            )
            for terms, numbers in given
        ]
        found.append(both[0] / np.where(both[1] > 0, both[1], np.nan))
    change = np.concatenate(found)
    return np.where((change > 1 / MOST) & (change < MOST), change, np.nan)
