"""The base fit of a whole test: its record, the gas of its condition, the base model."""

from plasmapyro.diagnosis.fit import no_plasma
from plasmapyro.diagnosis.fit.base import fit_base, guess_temperature
from plasmapyro.diagnosis.fit.build import base_model
from plasmapyro.diagnosis.fit.given_gas import of_gas, with_gas
from plasmapyro.diagnosis.fit.prior import relative, with_prior
from plasmapyro.diagnosis.fit.steep import steep
from plasmapyro.diagnosis.fit.terms import with_own
from plasmapyro.diagnosis.gas.library import gas_library
from plasmapyro.record.calibrated import of_pixels
from plasmapyro.record.foreign import without_narrow_light
from plasmapyro.record.inputs import has_plasma, instruments
from plasmapyro.record.record import record_of

LUKEWARM = 1000.0  # [K], to begin with


def fit_test(
    test,
    radiation,
    variations,
    response,
    calibration=None,
    spectrometer_calibration=None,
    *,
    saturation_counts,
    given=(),
    known=None,
    radiometer_calibration=None,
    room=None,
):
    """Base fit of a test; parameters as of `stage.diagnose`."""
    if spectrometer_calibration is not None and "spectrometer" in instruments(test):
        spectrometer_calibration = of_pixels(spectrometer_calibration, test)
    calibrations = {"spectrometer": spectrometer_calibration}
    if calibration is not None:
        calibrations["pyrometer"] = calibration
    if radiometer_calibration is not None:
        calibrations["radiometer"] = radiometer_calibration
    given = with_own(given, test)
    record = record_of(test, calibrations, saturation_counts=saturation_counts)
    if not record.instruments:
        raise ValueError(
            "the test holds signals of bands only: calibration.nc of the pyrometer is needed, or that of the"
            " radiometer"
        )
    fwhm = float(test.attrs.get("spectrometer_fwhm", 0.75e-9))
    plasma = has_plasma(test)
    if not plasma:
        record = no_plasma.timed(without_narrow_light(record))
        given = no_plasma.of_instrument(given, record, spectrometer_calibration, room)
    gas = [term for term in given if of_gas(term)]
    given = tuple(term for term in given if not of_gas(term))
    rest = calibration, response, spectrometer_calibration, given, radiometer_calibration
    if plasma:
        library = gas_library(str(test.attrs["condition"]), radiation, variations, fwhm=fwhm)
        library, power = with_gas(library, gas)
        model = base_model(record, library, *rest, power)
        faster = steep(model)
        model = model if faster is None else base_model(record, library, *rest, power, faster)
    else:
        first = base_model(record, no_plasma.dark_library(fwhm, LUKEWARM), *rest)
        library = no_plasma.dark_library(fwhm, float(guess_temperature(first).max()))
        model = base_model(record, library, *rest)
    return fit_base(model if known is None else with_prior(model, relative(known, model)))
