"""What a campaign says of the instruments and the emittance, put into a test and its calibrations."""

import numpy as np

RATIOS = ("sensitivity_ratio", "calibration_ratio", "fitted_ratio", "fit_coefficient")


def applied(test, calibrations, law):
    r"""A test and its calibrations (contract -> Dataset) as the `law` (`Normal`) of a campaign has them.

    .. math:: k_i' = k_i\,e^{g + r_i}, \; H' = H\,e^{r}, \; F'(\lambda) = F(\lambda)\,e^{-g - s(\lambda)}

    with the throughputs g, the ratio r of the bands and the scale s of the spectrometer; the stated emittance
    becomes that of the law. Errors of edges and lamp stay those of the calibration.
    """
    number = {name: (float(m), float(s)) for name, m, s in zip(law.names, law.mean, law.sigma, strict=True)}
    found = dict(calibrations)
    if "emittance" in number and "emittance" in test.attrs:
        mean, sigma = number["emittance"]
        value = min(float(np.exp(mean)), 1.0)
        test = test.assign_attrs(emittance=value, emittance_uncertainty=value * sigma)
    if "calibration" in found:
        found["calibration"] = _pyrometer(found["calibration"], number)
    gain = number.get("gain_spectrometer", (0.0, 0.0))[0]
    if "spectrometer_calibration" in found:
        one = found["spectrometer_calibration"]
        names = [name for name in one if name.startswith("calibration_factor")]
        found["spectrometer_calibration"] = one.assign(
            {name: one[name] * np.exp(-gain - _scale(number, one)) for name in names}
        )
    if "spectral_radiance" in test:
        radiance = test["spectral_radiance"] * np.exp(-gain - _scale(number, test))
        test = test.assign(spectral_radiance=radiance)
    return test, found


def _pyrometer(calibration, number):
    gain = number.get("gain_pyrometer", (0.0, 0.0))[0]
    ratio, sigma = number.get("ratio", (0.0, None))
    changed = {name: calibration[name] * np.exp(ratio) for name in RATIOS if name in calibration}
    changed["absolute_sensitivity"] = calibration["absolute_sensitivity"] * np.exp([gain + ratio, gain])
    if sigma is not None:
        changed["sensitivity_ratio_uncertainty"] = sigma * changed["sensitivity_ratio"]
        known = float(calibration["sensitivity_ratio_uncertainty"] / calibration["sensitivity_ratio"])
        changed["fit_covariance"] = (
            calibration["fit_covariance"] * (min(sigma / known, 1.0) * np.exp(ratio)) ** 2
        )
    return calibration.assign(changed)


def _scale(number, dataset):
    """Scale of the spectrometer at the pixels of a dataset, 0 without any."""
    known = sorted((float(name[6:]), value[0]) for name, value in number.items() if name.startswith("scale_"))
    if not known or "wavelength" not in dataset:
        return 0.0
    return np.interp(dataset["wavelength"].values * 1e9, *zip(*known, strict=True))
