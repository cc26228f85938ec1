r"""What both instruments would see of a test: the model that estimates and diagnoses compare with data.

.. math:: L(\lambda, t) = \tau\,[\varepsilon B(\lambda, T) + (1-\varepsilon) L_{gs} + g(t) L_{ge} + L_x]

with the incident gas light L_gs, the foreground L_x and a transmittance tau that differs from 1 only
under an effect. Pyrometer: `S_i = k_i Theta int R_i L dlambda` [A]; spectrometer: radiance through its
slit, meaned over bins of pixels.

How to use it
-------------
>>> model = forward_model(response, calibration, {80e3: radiation}, pixels, fwhm)  # stage.py
>>> scene = Scene(time, temperature, gas_amplitude, injected, emittance=0.85, power=80e3)
>>> seen = signals(model["pyrometer"], scene, effects=[...])     # model.py
>>> seen.value, seen.slope     # (t, C): signal, and its derivative by the surface temperature

`grey_signals` gives the same for a grey surface and no effects from tables, in about a millisecond.

Effects
-------
An effect is a callable with an attribute `stage`. `signals` applies effects in the order of `STAGES`,
and within a stage in the order given:

source, surface, path, optics
    get a `Light` and return one (`light.replace(...)`). Source effects change `gas`, `incident`; surface
    effects `emittance` (and `emittance_slope`, if it depends on the temperature), `incident`; path and
    optics effects `foreground`, `transmittance`. Fields broadcast to (t, B); those not touched stay (1, 1)
    or (1, B) and cost nothing.
detector, clock
    get a `Signals` and return one; `Signals.mapped(value, derivative)` keeps the slope right. A clock effect
    resamples the signals in time.

`transmittance` acts on everything when the radiance is formed. Without effects the result is, bit for
bit, that of the base model. `light.instrument` tells which instrument looks; `light.scene` holds time,
temperature and phases. Wavelengths are the middles of bins; a line narrower than its bin adds its
integral over the bin size, `light.bin_size`.
"""
