"""What the status of a temperature means."""

import numpy as np

from plasmapyro.instrument.calibration import ABOVE, BELOW, EXTRAPOLATED, VALID

MISSING = 3  # a sample is absent
NO_SIGNAL = 4  # what the surface adds cannot be told from zero
GAS_DOMINATED = 5  # the gas gives more than the allowed share of a signal
NOT_INJECTED = 6  # no sample in view
STRADDLING = 7  # the exposure holds the injection or the end of the plasma
SATURATED = 8  # the detector or its converter was at its limit
CONTRADICTED = 9  # instruments, or one and its calibration, contradict each other

WITH_VALUE = (VALID, EXTRAPOLATED, GAS_DOMINATED)  # all others go with NaN

MEANINGS = {
    BELOW: "below_range",
    VALID: "valid",
    ABOVE: "above_range",
    EXTRAPOLATED: "calibration_extrapolated",
    MISSING: "missing",
    NO_SIGNAL: "no_signal",
    GAS_DOMINATED: "gas_dominated",
    NOT_INJECTED: "not_injected",
    STRADDLING: "straddling",
    SATURATED: "saturated",
    CONTRADICTED: "contradicted",
}


def flags():
    """CF attributes of a status variable."""
    return {
        "flag_values": np.array(list(MEANINGS), dtype="int8"),
        "flag_meanings": " ".join(MEANINGS.values()),
    }
