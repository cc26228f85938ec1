"""What the status of a temperature means."""

from plasmapyro import checks
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
    return checks.flags(MEANINGS)


REASONS = {  # in words of a user
    BELOW: "the ratio belongs to a temperature below what the instrument reads",
    VALID: "",
    ABOVE: "the ratio belongs to a temperature above what the instrument reads",
    EXTRAPOLATED: "outside the calibration points, inside the instrument's range",
    MISSING: "no sample was recorded",
    NO_SIGNAL: "what is left without the gas cannot be told from zero",
    GAS_DOMINATED: "the gas gives more than the allowed share of a signal",
    NOT_INJECTED: "no surface in view",
    STRADDLING: "the exposure holds a switch of the plasma",
    SATURATED: "the detector or its converter was at its limit",
    CONTRADICTED: "instruments, or one and its calibration, contradict each other",
}
