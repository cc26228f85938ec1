"""What a result tells of its test."""

CARRIED = (
    "title",
    "origin",
    "condition",
    "injection_time",
    "plasma_off_time",
    "reference_window",
    "emittance",
    "emittance_uncertainty",
    "temperature_spread",
)


def carried(test):
    """Attributes of a test that its results carry on."""
    return {name: test.attrs[name] for name in CARRIED if name in test.attrs}
