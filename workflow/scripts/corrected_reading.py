"""Rule corrected_reading: the surface behind the gas, where only the displayed temperature was logged."""

from plasmapyro import io
from plasmapyro.analysis.reading import correct_reading
from plasmapyro.commands.correct_reading import read_readings
from plasmapyro.quantities import in_si

io.log_to(snakemake.log[0])
paths, keys = snakemake.input, snakemake.params.settings
gas = [io.read(paths[name], name) for name in ("gas_signal", "response", "ratio_curve")]
time, reading = read_readings(paths.display, keys.get("slope", 1.0))
result = correct_reading(*gas, time=time, reading=reading, **in_si(keys))
io.write(result, snakemake.output[0], "corrected_reading", sources=paths, config=dict(keys))
