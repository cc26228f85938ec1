"""Rule joint_estimate: surface temperature from everything the instruments of a test give."""

from plasmapyro import io
from plasmapyro.estimate.stage import estimate

io.log_to(snakemake.log[0])
files, keys = snakemake.input, dict(snakemake.params)
seconds = ("gas_flicker_time", "injection_time_span", "plasma_off_time_span")
kelvins = ("initial_temperature", "initial_temperature_uncertainty")
same = ("gas_drift", "gas_flicker", "gas_change", "scale_uncertainty", "bin_uncertainty", "instruments")
limits = ("least_surface_share", "largest_uncertainty", "saturation_counts")
result = estimate(
    io.read(files.test, "test"),
    io.read(files.calibration, "calibration"),
    io.read(files.response, "response"),
    io.read(files.spectrometer, "spectrometer_calibration") if files.spectrometer else None,
    band_shift_uncertainty=keys["band_shift_uncertainty_nm"] * 1e-9,
    noise_block=keys["noise_block_pixels"],
    **{name: keys[name] for name in same + limits},
    **{name: keys[f"{name}_s"] for name in seconds},
    **{name: keys[f"{name}_k"] for name in kelvins},
)
io.write(result, snakemake.output[0], "joint_estimate", sources=files, config=keys)
