"""Files of effects that are taken as given, as `plasmapyro diagnose` writes them."""

from types import MappingProxyType

from plasmapyro import configuration, progress
from plasmapyro.diagnosis.effects.catalogue import CATALOGUE
from plasmapyro.diagnosis.effects.condition import OF_CONDITION, OF_FLOW, species_of
from plasmapyro.diagnosis.fit.terms import terms_of

OF_TEST = MappingProxyType(
    {name: one for name, one in CATALOGUE.items() if not (one.steady_gas and one.stage == "gas")}
)
STAGES = ("path", "optics", "detector", "clock")  # of what an instrument does in every test
OF_INSTRUMENT = MappingProxyType({name: one for name, one in OF_TEST.items() if one.stage in STAGES})
OF = {"test": OF_TEST, "condition": OF_CONDITION}
EVERY = MappingProxyType(
    dict.fromkeys(OF_TEST, "tests (config/tests)")
    | dict.fromkeys(OF_CONDITION, "conditions (config/conditions)")
)
CHANGES = MappingProxyType(
    {
        "temperature": "P_eff",
        "excitation": "T_exc",
        "vibration": "T_vib",
        "ripple": "ripple",
        "depth": "selfabs",
        "continuum": "contin",
    }
)


def read_terms(path, owner="test"):
    """Terms of the `owner` 'test' or 'condition' of a file terms.yaml, each with `effects`.

    ValueError names every fault of the file.
    """
    values = configuration.read(path)
    parts = values if isinstance(values, dict) else {}
    if not parts or set(parts) - set(OF) or not all(isinstance(one, dict) for one in parts.values()):
        raise ValueError(f"{path}: must hold 'test' and 'condition', each with a list 'effects'")
    odd = [f"{name}.{key}" for name, one in parts.items() for key in one if key != "effects"]
    if odd:
        raise ValueError(f"{path}: unknown key {', '.join(odd)}; valid: effects")
    found, faults = {}, []
    for name, one in parts.items():
        try:
            found[name] = terms_of(one.get("effects", []), OF[name], f"{name}.effects", EVERY)
        except ValueError as wrong:
            faults.append(str(wrong))
    if faults:
        raise ValueError("\n  ".join([f"{path}:", *faults]))
    return found.get(owner, ())


def absent(terms, instruments):
    """Those of some terms that act on none of the instruments of a test; a radiometer counts as pyrometer."""
    kinds = {{"radiometer": "pyrometer"}.get(one, one) for one in instruments}
    return [term for term in terms if not kinds & set(term.setting.effect.instruments)]


def warn_of_absent(terms, instruments):
    """Say which of some terms act on none of the instruments of a test."""
    for term in absent(terms, instruments):
        progress.warn(f"{term.setting.id} acts on an instrument that the test lacks: it changes nothing")


def check_effects(cases, owner, folder):
    """Refuse files of a folder, of tests or conditions (`owner`), with `effects` that they may not hold."""
    faults = []
    for name, case in cases.items():
        try:
            terms_of(case.get("effects", []), OF[owner], elsewhere=EVERY)
        except ValueError as fault:
            faults.append(f"{folder}/{name}.yaml:\n  {fault}")
    if faults:
        raise configuration.ConfigurationError("\n".join(faults))


def given_terms(entries, path=None):
    """Terms of a test: those of its file, or of a file terms.yaml."""
    return read_terms(path) if path else terms_of(entries, OF_TEST)


def with_instrument(entries, tests):
    """Tests whose effects hold those of the instrument as well; an effect that a test states itself counts.

    ConfigurationError: `entries` (`instrument.effects` of the configuration) that are not effects of window,
    optics, detector or clock.
    """
    try:
        terms_of(entries, OF_INSTRUMENT, "instrument.effects", EVERY)
    except ValueError as fault:
        raise configuration.ConfigurationError(str(fault)) from None

    def joined(own):
        stated = {one["id"] for one in own}
        return [*own, *(one for one in entries if one["id"] not in stated)]

    return {name: case | {"effects": joined(case.get("effects", []))} for name, case in tests.items()}


def with_effects(conditions):
    """Conditions at the power and mixing that their effects give them, and what else changes in their light.

    Powers have at most six digits; the changes, name -> mapping as of `changes_of`, only where there are any.
    ConfigurationError: another power or mixing for the flow of another program.
    """
    found, changes = {}, {}
    for name, case in conditions.items():
        terms = terms_of(case.get("effects", []), OF_CONDITION)
        change, mixing = (amplitude_of(terms, one) for one in OF_FLOW)
        found[name] = case
        for one in [one for one in OF_FLOW if amplitude_of(terms, one) and "cfd" in case]:
            raise configuration.ConfigurationError(
                f"effects of {name}: '{one}' solves the flow again, and the flow of this condition is another"
                " program's: compute it there at the other power or mixing"
            )
        if change:
            power = f"{case['numerical_power_kw'] * (1 + change):.6g}"
            found[name] = found[name] | {"numerical_power_kw": float(power)}
        if mixing:
            found[name] = found[name] | {"mixing": mixing}
        if changed := changes_of(terms):
            changes[name] = changed
    return found, changes


def changes_of(terms):
    """What terms of a condition change in the light of its gas, as `radiance_with` takes it.

    Amplitudes by the names of `CHANGES`, `continuum_own` as of the effect `contin`, and `lines` {species:
    tenths of O I 777}; empty for nothing.
    """
    found = {name: amplitude_of(terms, identity) for name, identity in CHANGES.items()}
    if found["continuum"]:
        (shape,) = (term.setting.shape for term in terms if term.setting.id == CHANGES["continuum"])
        found["continuum_own"] = shape["own"]
    lines = {species_of(term.setting.id): term.setting.amplitude for term in terms}
    found["lines"] = {species: amount for species, amount in lines.items() if species and amount}
    return {name: change for name, change in found.items() if change}


def amplitude_of(terms, identity):
    """Amplitude of the term of an id, 0 without one."""
    return next((term.setting.amplitude for term in terms if term.setting.id == identity), 0.0)
