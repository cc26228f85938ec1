"""The estimator `joint` of `plasmapyro correct`: one temperature from all that the instruments give."""

from plasmapyro import io, progress
from plasmapyro.commands.options import settings
from plasmapyro.estimate.stage import estimate
from plasmapyro.record.inputs import has_plasma, instruments

# As experiment.joint_estimate of the workflow's configuration, in SI.
SETTINGS = {
    "gas_drift": 0.1,
    "gas_flicker": 0.01,
    "gas_flicker_time": 0.3,
    "gas_change": 0.03,
    "band_shift_uncertainty": 1e-9,
    "initial_temperature": 350.0,
    "initial_temperature_uncertainty": 50.0,
    "scale_uncertainty": 0.03,
    "bin_uncertainty": 0.002,
    "injection_time_span": 1.0,
    "plasma_off_time_span": 0.3,
    "least_surface_share": 0.5,
    "largest_uncertainty": 0.03,
}


def by_joint_inference(test, calibrations, options):
    """Surface temperature (contract 'joint_estimate') inferred from bands and spectra together.

    Arguments as of `correct.by_reference`. ValueError if the test has bands of neither pyrometer nor
    radiometer, or no plasma.
    """
    present = instruments(test)
    if not {"pyrometer", "radiometer"} & set(present):
        raise ValueError(
            "--estimator joint needs the bands of a pyrometer or a radiometer; use --estimator reference"
        )
    if not has_plasma(test):
        other = "emissivity" if "radiometer" in present else "reference"
        raise ValueError(f"--estimator joint follows the light of a plasma; use --estimator {other}")
    progress.say("inferring the temperature from all samples together: some 5 s")
    return estimate(
        test,
        calibrations.get("calibration"),
        io.read(f"{options.instrument}/response.nc", "response") if "pyrometer" in present else None,
        calibrations.get("spectrometer_calibration"),
        radiometer_calibration=calibrations.get("radiometer_calibration"),
        **settings(options, estimate) | SETTINGS,
    )
