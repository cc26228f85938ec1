"""One formula of the analyser's catalogue made wrong: a test that still passes is blind."""

from dataclasses import replace

import numpy as np


def sabotaged(effect):
    """The catalogue with a wrong formula for one effect: what it changes is mirrored in time.

    A sign or a factor would only change the amplitude that is found; the history is what names an effect.
    """
    from plasmapyro.diagnosis.effects.catalogue import CATALOGUE

    entry = CATALOGUE[effect]
    changes = {"light": _mirrored_light(entry.light), "output": _mirrored_output(entry.output)}
    if entry.clock is not None:
        changes["clock"] = lambda amplitude, kind, **shape: 0.0
    return {**CATALOGUE, effect: replace(entry, **changes)}


def _mirrored_output(apply):
    if apply is None:
        return None

    def wrong(output, amplitude, **shape):
        right = apply(output, amplitude, **shape)
        return output.value + (right - output.value)[::-1]

    return wrong


def _mirrored_light(apply):
    if apply is None:
        return None

    def wrong(scene, amplitude, **shape):
        share = np.cos(2 * np.pi * np.clip(scene.time, 0, scene.off_time) / scene.off_time)
        # The effect swings instead of keeping its own history.
        right, none = apply(scene, amplitude, **shape), scene
        path = none.path + (right.path - none.path) * share[..., None]
        gas = [(weight * share, spectrum) for weight, spectrum in right.more_gas[len(none.more_gas) :]]
        emittance = none.emittance + (right.emittance - none.emittance) * share[..., None]
        return right.but(
            path=path,
            emittance=emittance,
            glow=none.glow + (right.glow - none.glow) * share[..., None],
            added=none.added + (right.added - none.added) * share[..., None],
            more_gas=(*none.more_gas, *gas),
            spectrum=none.spectrum,
            response_shift=tuple(-one for one in right.response_shift),
            slit_sigma2=none.slit_sigma2,
        )

    return wrong
