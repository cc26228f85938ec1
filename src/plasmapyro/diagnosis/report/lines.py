"""Names of the lines that the extended model leaves in the spectra, as effects that can be kept."""

import numpy as np

from plasmapyro.diagnosis.effects.gas import JET_EXCITATION, line_spectrum, lines_of
from plasmapyro.identification.identify import identify
from plasmapyro.refraction import air_wavelength

LEAST = 0.5  # probability from which a species is proposed
STRONGEST = 4  # lines that are listed


def lines_left(findings):
    """Species whose lines the spectra hold besides the extended model, see `species_left`.

    Where no structure is left that the catalogue does not explain, nothing is looked for.
    """
    if findings.selection.unknown_class is None:
        return []
    for which, instrument in enumerate(findings.model.instruments):
        if instrument.kind == "spectrometer":
            use = instrument.time < findings.model.off
            left = instrument.value[use] - findings.final.prediction[which][use]
            with np.errstate(divide="ignore", invalid="ignore"):
                sigma = np.abs(left / findings.residuals[1][which][use])
            weight = np.where(np.isfinite(sigma) & (sigma > 0), sigma, np.inf) ** -2.0
            total = np.maximum(weight.sum(axis=0), 1e-300)
            mean = np.where(weight > 0, weight * np.nan_to_num(left), 0.0).sum(axis=0) / total
            return species_left(instrument.wavelength, mean, total**-0.5, findings.model.library)
    return []


def species_left(wavelength, left, sigma, library):
    """Species behind light that a model leaves, and the effects that would explain it.

    `left`, `sigma` (C,) [W m-2 sr-1 m-1]: mean light besides the model while the plasma burns, and its
    standard deviation, in channels [m] in vacuum; the O I triplet of the library is the unit of the
    amplitude. One dict each: `species`, `probability`, `lines` [m] (in air), `rivals`, and `effect` with id,
    amplitude and its standard `uncertainty`, as under the key `effects`.
    """
    usable = np.isfinite(left) & (sigma < 1e3 * np.median(sigma))
    wavelength, left, sigma = wavelength[usable], left[usable], sigma[usable]
    answer = identify(air_wavelength(wavelength), left, sigma, library.slit_fwhm, calibrated=True)
    found = []
    for one in answer.named:
        if one.probability >= LEAST:
            shape = line_spectrum((one.species.name,), library, JET_EXCITATION)
            shape = np.interp(wavelength, library.wavelength, shape) / sigma
            matched = one.fit.matched[np.argsort(-answer.peaks.light[one.fit.matched], kind="stable")]
            places = np.sort(answer.peaks.wavelength[matched[:STRONGEST]])
            size = max(float(shape @ shape), 1e-300)
            effect = {
                "id": lines_of(one.species.name).id,
                "amplitude": max(float(shape @ (left / sigma)) / size, 0.0),
                "uncertainty": size**-0.5,
            }
            found.append(
                {
                    "species": one.species.name,
                    "probability": one.probability,
                    "lines": [float(place) for place in places],
                    "rivals": list(one.rivals),
                    "effect": effect,
                }
            )
    return found
