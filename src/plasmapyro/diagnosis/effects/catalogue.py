"""The catalogue: everything that the diagnosis knows by name, in the order of the way of the light."""

from types import MappingProxyType

from plasmapyro.diagnosis.effects import gas, instrument, path, surface
from plasmapyro.diagnosis.effects.effect import Effect

CATALOGUE = MappingProxyType(
    {
        found.id: found
        for module in (surface, gas, path, instrument)
        for found in vars(module).values()
        if isinstance(found, Effect)
    }
)


# Effects whose formulas take spectra of `variations`.
NEED_VARIATIONS = ("P_eff", "ripple", "T_exc", "T_vib", "selfabs", "refl", "bl", "CN")


def without(effects, ids):
    """The effects {id: Effect} but for some.

    Raises
    ------
    ValueError
        An id that is not among them.
    """
    unknown = set(ids) - set(effects)
    if unknown:
        raise ValueError(
            f"exclude must name effects among {', '.join(effects)}; got {', '.join(sorted(unknown))}"
        )
    return MappingProxyType({identity: one for identity, one in effects.items() if identity not in ids})
