"""Names of the lines that the simulated gas lacks or the extended model leaves in the spectra."""

import numpy as np

from plasmapyro.diagnosis.report.foreign import species_left


def species_of(findings):
    """Species whose lines the simulated gas lacks, then those of light that the extended model leaves."""
    known = {one["species"] for one in findings.foreign}
    return [*findings.foreign, *(one for one in lines_left(findings) if one["species"] not in known)]


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
