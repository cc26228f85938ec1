"""Synthetic twin of a published plasma-wind-tunnel test.

Makes the files that a laboratory would hand over, from a hidden truth. It shares no code with
`plasmapyro` (own Planck law, own quadrature, own sample model, own noise), so that the processing
is tested against something it did not write. The only things both sides see are data files: the
responses of the instrument and the radiance of the gas.
"""
