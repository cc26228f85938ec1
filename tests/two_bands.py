"""The pyrometer of the tests: a silicon sandwich behind a cut-on filter, as in the paper."""

from plasmapyro.commands import calibrate
from plasmapyro.instrument.stage import band_response

RESPONSE = band_response(**calibrate.RESPONSE)
