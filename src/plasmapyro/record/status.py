"""What the status of a temperature means."""

from plasmapyro import checks
from plasmapyro.instrument.calibration import ABOVE as ABOVE
from plasmapyro.instrument.calibration import BELOW as BELOW
from plasmapyro.instrument.calibration import EXTRAPOLATED, VALID
from plasmapyro.tables import rows

MISSING = 3  # a sample is absent
NO_SIGNAL = 4  # what the surface adds cannot be told from zero
GAS_DOMINATED = 5  # the gas gives more than the allowed share of a signal
NOT_INJECTED = 6  # no sample in view
STRADDLING = 7  # the sample, or exposure, holds the injection or the end of the plasma
SATURATED = 8  # the detector or its converter was at its limit
CONTRADICTED = 9  # instruments, or one and its calibration, contradict each other

WITH_VALUE = (VALID, EXTRAPOLATED, GAS_DOMINATED)  # all others go with NaN

REGISTER = rows("record/status.csv")
MEANINGS = {int(row["code"]): row["word"] for row in REGISTER}
REASONS = {int(row["code"]): row["reason"] for row in REGISTER}  # in words of a user


def flags():
    """CF attributes of a status variable."""
    return checks.flags(MEANINGS)
