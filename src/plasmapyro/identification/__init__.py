"""Names of what emits lines and bands: species whose lines together explain the peaks of a spectrum."""
