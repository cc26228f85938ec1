"""What every netCDF file between two stages must contain: names, dims, units, ranges.

`VARIABLES` says once what a name means; `DATASETS` says which names a file holds, on which dims.
A name in `DATASETS` that ends in '?' is optional.
"""

from dataclasses import dataclass
from math import inf

import numpy as np


class ContractError(ValueError):
    """A dataset does not honour its contract; the message lists every breach."""


@dataclass(frozen=True)
class Variable:
    units: str  # "" for text
    long_name: str
    low: float = -inf
    high: float = inf
    nan_allowed: bool = False
    standard_name: str = ""


RADIANCE = "W m-2 sr-1 m-1"

VARIABLES = {
    # coordinates
    "condition": Variable("", "power condition"),
    "species": Variable("", "chemical species"),
    "component": Variable("", "radiating system"),
    "band": Variable("", "pyrometer band"),
    "wavelength": Variable("m", "wavelength in vacuum", 1e-7, 2e-5, standard_name="radiation_wavelength"),
    "wavelength_slit": Variable("m", "wavelength in vacuum, slit-convolved view", 1e-7, 2e-5),
    "time": Variable("s", "time since injection", nan_allowed=False),
    "spectrum_time": Variable("s", "time since injection, middle of each exposure"),
    # gas
    "temperature": Variable("K", "temperature", 100, 3e4),
    "pressure": Variable("Pa", "absolute pressure", 1, 1e7),
    "mole_fraction": Variable("1", "mole fraction", 0, 1 + 1e-9),
    "density": Variable("kg m-3", "density", 0, 1e3),
    "enthalpy": Variable("J kg-1", "specific enthalpy, equilibrium", -1e7, 1e10),
    "heat_capacity": Variable("J kg-1 K-1", "equilibrium specific heat at constant pressure", 0, 1e7),
    "viscosity": Variable("Pa s", "dynamic viscosity", 0, 1),
    "thermal_conductivity": Variable(
        "W m-1 K-1", "total thermal conductivity, reactive part included", 0, 1e3
    ),
    "electrical_conductivity": Variable("S m-1", "electrical conductivity", 0, 1e6),
    # flow
    "mesh": Variable("1", "UGRID topology of the triangles (attributes only)"),
    "node_z": Variable("m", "axial position of the node, 0 at the torch back wall", -100, 100),
    "node_r": Variable("m", "distance of the node from the axis", 0, 100),
    "face_node": Variable("1", "vertices of the triangle, counter-clockwise in (z, r)", 0),
    "face_midnode": Variable("1", "middle node of the edge from corner k to corner k+1 (mod 3)", 0),
    "solver_mesh_factor": Variable("1", "factor on the cell sizes of a mesh of the solver", 0),
    "solver_vertex_mesh": Variable("1", "mesh of the solver that the vertex belongs to", 0),
    "solver_vertex_z": Variable("m", "axial position of a vertex of flow domain or box", -100, 100),
    "solver_vertex_r": Variable("m", "distance of that vertex from the axis", 0, 100),
    "solver_triangle_mesh": Variable("1", "mesh of the solver that the triangle belongs to", 0),
    "solver_triangle_flow": Variable("1", "1: triangle of the flow domain, 0: of the box around it", 0, 1),
    "solver_triangle": Variable("1", "vertices of that triangle, counted within their mesh", 0),
    "axial_velocity": Variable("m s-1", "axial velocity", -5e3, 5e3),
    "radial_velocity": Variable("m s-1", "radial velocity, outward", -5e3, 5e3),
    "joule_heating": Variable("W m-3", "Joule heating, mean over a field period", 0, 1e12),
    "numerical_power": Variable("W", "Joule power of the simulated plasma", 0, 1e8),
    "chamber_pressure": Variable("Pa", "static pressure of the chamber", 1, 1e7, nan_allowed=True),
    "mass_flow_rate": Variable("kg s-1", "gas fed through the inlet slot", 0, 10, nan_allowed=True),
    "coil_current": Variable("A", "amplitude of the coil current", 0, 1e6),
    "equivalent_resistance": Variable("ohm", "plasma resistance seen by the coil", 0, 1e3),
    "boundary": Variable("", "part of the boundary"),
    "boundary_mass_flow": Variable("kg s-1", "mass leaving through the boundary", -10, 10),
    "boundary_enthalpy_flow": Variable("W", "enthalpy leaving with the gas, zero at the wall temperature"),
    "boundary_heat_flow": Variable("W", "conducted heat leaving through the boundary"),
    "mass_imbalance": Variable("1", "net mass outflow over gross mass outflow", -1, 1),
    "radiated_power": Variable("W", "power that the gas radiates away", 0, 1e8),
    "azimuthal_velocity": Variable("m s-1", "azimuthal velocity (swirl)", -5e3, 5e3),
    "temperature_error": Variable("K", "estimated error of the temperature from three meshes", 0, 3e4),
    "net_emission": Variable("W m-3", "net emission of the gas in the tabulated wavelengths", 0, 1e15),
    "energy_imbalance": Variable("1", "net energy outflow minus Joule power, over Joule power", -1, 1),
    "residual_norm": Variable("1", "norm of the discrete residual over that of gas at rest", 0),
    "velocity_change": Variable("m s-1", "largest velocity change of the Newton step", 0),
    "temperature_change": Variable("1", "largest relative temperature change of the Newton step", 0),
    "cfl_number": Variable("1", "Courant number of the pseudo-time step", 0),
    # diagnosis
    "core_change": Variable("1", "relative change of the temperature of the gas"),
    "core_radiance": Variable(RADIANCE, "radiance of the gas so much hotter, through the slit", 0),
    "variation": Variable("", "property of the gas that is varied"),
    "addition": Variable("", "light that is added to that of the gas"),
    "variation_amplitude": Variable(
        "1", "relative change of the property; optical depth of the strongest line"
    ),
    "varied_radiance": Variable(
        RADIANCE, "radiance of the gas with one property varied, through the slit", 0
    ),
    "added_radiance": Variable(
        RADIANCE, "light that may be added to that of the gas, through the slit", -1e12
    ),
    "model": Variable("", "model: base, or with the terms that the data ask for"),
    "time_bin": Variable("s", "time since injection, middle of the bin"),
    "time_edge": Variable("s", "ends of the time bin"),
    "wavelength_bin": Variable("m", "wavelength in vacuum, middle of the bin", 1e-7, 2e-5),
    "wavelength_edge": Variable("m", "ends of the wavelength bin, in vacuum", 1e-7, 2e-5),
    "measured_radiance": Variable(RADIANCE, "measured spectral radiance, mean of the bin", nan_allowed=True),
    "modelled_radiance": Variable(RADIANCE, "modelled spectral radiance, mean of the bin", nan_allowed=True),
    "radiance_residual": Variable(
        "1", "measured less modelled, over the standard deviation", nan_allowed=True
    ),
    "measured_signal": Variable("A", "measured band signal, mean of the bin", nan_allowed=True),
    "modelled_signal": Variable("A", "modelled band signal, mean of the bin", nan_allowed=True),
    "signal_residual": Variable("1", "measured less modelled, over the standard deviation", nan_allowed=True),
    "paper_temperature": Variable("K", "corrected temperature by the method of the paper", nan_allowed=True),
    **{
        f"{kind}_temperature{end}": Variable("K", f"temperature by the {kind} model{what}", nan_allowed=True)
        for kind in ("base", "extended")
        for end, what in (("", ""), ("_low", ", 2.5 % quantile"), ("_high", ", 97.5 % quantile"))
    },
    # analysis
    "gas_signal": Variable("W m-2 sr-1", "band signal of the gas along the line of sight", 0, 1e9),
    "sample_emittance": Variable("1", "grey emittance of the surface in the condition", 0, 1),
    "object_temperature": Variable("K", "true surface temperature", 100, 1e4),
    "visibility_level": Variable("1", "level of the visibility factor", 0, 1),
    "visibility_factor": Variable("1", "share of the surface in the band signal", 0, 1),
    "visibility_limit": Variable(
        "K", "surface temperature at which the visibility level is reached", 100, 1e4, nan_allowed=True
    ),
    "apparent_temperature": Variable("K", "temperature read through the gas", 100, 1e4, nan_allowed=True),
    "relative_error": Variable(
        "1", "apparent minus true temperature over the true one", -1, 1e3, nan_allowed=True
    ),
    "reading_status": Variable("1", "-1 below, 0 within, +1 above the modelled ratio curve", -1, 1),
    "emittance": Variable("1", "grey emittance of the surface", 0, 1),
    "error_limit": Variable(
        "K", "surface temperature above which the error does not exceed the level", 100, 1e4, nan_allowed=True
    ),
    "limit_status": Variable("1", "-1 limit below, 0 within, +1 above the temperatures studied", -1, 1),
    "object_temperature_history": Variable("K", "true surface temperature while heating", 100, 1e4),
    "surface_radiance": Variable(RADIANCE, "radiance of the grey surface", 0, 1e17),
    # parameter study
    "flow_status": Variable("1", "0 computed, 1 plasma goes out, 2 no steady flow found, 3 not asked", 0, 3),
    "study_status": Variable("1", "status of the flow of the condition, see flag_meanings", 0, 3),
    "sightline_angle": Variable("rad", "angle between line of sight and jet axis", 0, np.pi / 2),
    "peak_temperature": Variable("K", "highest temperature of the gas along the line of sight", 100, 3e4),
    "study_reading_status": Variable(
        "1", "-1 below, 0 within, +1 above the modelled ratio curve, +2 gas not known", -1, 2
    ),
    "study_limit_status": Variable(
        "1", "-1 limit below, 0 within, +1 above the temperatures studied, +2 gas not known", -1, 2
    ),
    # radiation
    "gas_radiance": Variable(RADIANCE, "spectral radiance of the gas at the end of the sight line"),
    "gas_radiance_component": Variable(RADIANCE, "the same by radiating system, absorbed by all"),
    "component_uncertainty": Variable("1", "relative uncertainty of the strength of a system", 0, 10),
    "optical_depth": Variable("1", "optical depth of the whole sight line", -1e-6, 1e6),
    "gas_radiance_slit": Variable(RADIANCE, "spectral radiance of the gas through a Gaussian slit"),
    "gas_radiance_component_slit": Variable(RADIANCE, "the same by radiating system"),
    "band_signal": Variable("W m-2 sr-1", "radiance of the gas weighted with the response", 0, 1e9),
    "band_signal_thin": Variable("W m-2 sr-1", "the same without absorption", 0, 1e9),
    "band_signal_gridless": Variable("W m-2 sr-1", "the same without absorption and without a grid", 0, 1e9),
    "reflection": Variable("", "how the surface reflects: specular or diffuse"),
    "incident_radiance": Variable(
        RADIANCE, "radiance of the gas a perfect reflector would send back to the instrument"
    ),
    "incident_radiance_component": Variable(RADIANCE, "the same by radiating system, absorbed by all"),
    "incident_radiance_slit": Variable(RADIANCE, "the same through a Gaussian slit"),
    "incident_signal": Variable("W m-2 sr-1", "the same weighted with the response", 0, 1e9),
    "ray_signal": Variable(
        "W m-2 sr-1", "radiance arriving along the ray, weighted with the response", 0, 1e9
    ),
    "surface": Variable("", "how the sample returns the light of the gas"),
    "correction": Variable("", "what was subtracted from the signals"),
    "neglect_limit": Variable(
        "K",
        "surface temperature above which neglecting the reflection costs less than the tolerance",
        100,
        1e4,
        True,
    ),
    # design
    "state": Variable("", "temperature of the gas: as computed, colder, hotter"),
    "binned_radiance": Variable(
        RADIANCE, "mean spectral radiance of the gas in the bin, line of sight", -1.0
    ),
    "incident_binned": Variable(RADIANCE, "mean radiance a perfect reflector would send back", -1.0),
    "design": Variable("", "pyrometer"),
    "design_kind": Variable("", "how the pyrometer was found"),
    "design_detector": Variable("", "its detector"),
    "design_shape": Variable("", "shape of its bands"),
    "error_source": Variable("", "source of error"),
    "perturbation": Variable("", "change of the gas"),
    "band_centre": Variable("m", "middle of the band", 1e-7, 2e-5, nan_allowed=True),
    "band_width": Variable("m", "full width at half maximum of the band", 0, 2e-5, nan_allowed=True),
    "band_weight": Variable("1", "weight of the logarithm of the band's signal", nan_allowed=True),
    "total_error": Variable("1", "root mean square of the total relative error", 0, 10, nan_allowed=True),
    "error_by_source": Variable(
        "1", "root mean square of the relative error by source", 0, 1e6, nan_allowed=True
    ),
    "ratio_sensitivity": Variable("1", "relative change of the reading's ratio per that of T", 0, 1e3, True),
    "design_score": Variable("1", "what the search minimised", 0, 100, nan_allowed=True),
    "design_limit": Variable(
        "K", "temperature above which the gas error stays below the level", 100, 1e4, True
    ),
    "design_gain": Variable("K", "by how much that lies below the reference's", -1e4, 1e4, nan_allowed=True),
    "gain_change": Variable("1", "gain in the changed gas over the gain", -1e4, 1e4, nan_allowed=True),
    "map_limit": Variable("K", "the same temperature over the emittance", 100, 1e4, nan_allowed=True),
    "candidate_sensitivity": Variable("1", "sensitivity of the pair's ratio to the temperature", 0, 1e3),
    "candidate_limit": Variable(
        "K", "mean over the conditions of the pair's temperature limit", 100, 1e4, True
    ),
    "candidate_score": Variable(
        "1", "what the search minimises; one detector only", 0, 100, nan_allowed=True
    ),
    "candidate_on_front": Variable("1", "1 on the Pareto front", 0, 1),
    "candidate_centre": Variable("m", "middles of the pair's bands", 1e-7, 2e-5),
    "candidate_width": Variable("m", "widths of the pair's bands", 0, 2e-5),
    "setup": Variable("", "instrument with or without a second measurement"),
    "trust_level": Variable("1", "size of the relative error", 0, 1),
    "trust_temperature": Variable(
        "K", "temperature from which the error stays below the level", 100, 1e4, True
    ),
    "trust_time": Variable("s", "time after injection at which it is reached", 0, 1e6, nan_allowed=True),
    "own_uncertainty": Variable("1", "relative standard uncertainty without gas", 0, 10, nan_allowed=True),
    # instrument
    "responsivity_wide": Variable("1", "spectral response of the wide band over its peak", 0, 1),
    "responsivity_narrow": Variable("1", "spectral response of the narrow band over its peak", 0, 1),
    "source_temperature": Variable("K", "temperature of the blackbody calibration source", 100, 1e4),
    "source_temperature_uncertainty": Variable("K", "its standard uncertainty", 0, 1e3),
    "signal_wide": Variable("A", "signal of the wide band, S1", nan_allowed=True),
    "signal_narrow": Variable("A", "signal of the narrow band, S2", nan_allowed=True),
    "sensitivity_ratio": Variable("1", "sensitivity of the wide over that of the narrow band", 0, 1e6),
    "sensitivity_ratio_uncertainty": Variable("1", "standard uncertainty of the sensitivity ratio", 0, 1e6),
    "absolute_sensitivity": Variable("A m2 sr W-1", "signal per band signal, k times throughput", 0, 1),
    "absolute_sensitivity_uncertainty": Variable("A m2 sr W-1", "its standard uncertainty", 0, 1),
    "point_ratio": Variable("1", "signal ratio at the calibration point", 0, 1e6),
    "model_residual": Variable("1", "point ratio over the modelled ratio, minus 1", -1, 1e3),
    "fit_residual": Variable("1", "point ratio over the quadratic fit, minus 1", -1, 1e3),
    "calibration_temperature": Variable("K", "temperature of the calibration curve", 100, 1e4),
    "calibration_ratio": Variable("1", "modelled signal ratio of a black body, H_c", 0, 1e6),
    "fitted_ratio": Variable("1", "quadratic fit of the ratio; NaN where it does not rise", 0, 1e6, True),
    "temperature_uncertainty": Variable(
        "K", "standard uncertainty of a temperature read with the quadratic fit", 0, 1e4, nan_allowed=True
    ),
    "fit_coefficient": Variable("1", "coefficients of the quadratic fit, in rising powers of the scaled T"),
    "fit_covariance": Variable("1", "covariance of the coefficients of the quadratic fit"),
    "fit_range": Variable("K", "lowest and highest temperature of the calibration points", 100, 1e4),
    "instrument_range": Variable("K", "lowest and highest temperature the instrument reads", 100, 1e4),
    "calibration_counts": Variable("count", "raw signal in front of the source", nan_allowed=True),
    "calibration_background": Variable("count", "raw signal in the dark", nan_allowed=True),
    "calibration_factor": Variable(
        "W m-2 sr-1 m-1 s count-1", "radiance per count rate; NaN in unusable pixels", 0, 1e20, True
    ),
    "calibration_factor_uncertainty": Variable(
        "1", "relative standard uncertainty of the factor from counting noise", 0, 1e6, nan_allowed=True
    ),
    "calibration_factor_common": Variable(
        "1", "relative standard uncertainty of the factor that all pixels share", 0, 1e6, nan_allowed=True
    ),
    "exposure_counts": Variable("count", "raw signal of each exposure of the source", nan_allowed=True),
    "exposure_dark": Variable("count", "raw signal of the dark of each exposure", nan_allowed=True),
    "exposure_time": Variable("s", "integration time of each exposure", 0, 1e5),
    "linearity_coefficient": Variable(
        "1", "coefficient of counts^k in the relative response of the detector"
    ),
    "masked_pixel": Variable("1", "index of a pixel that no light reaches", -1e6, 1e6),
    "dark_scale": Variable("1", "dark current in the exposure over that in its dark", 0, 100),
    "source_radiance": Variable(RADIANCE, "spectral radiance of the source, certified", nan_allowed=True),
    "source_radiance_uncertainty": Variable("1", "its relative standard uncertainty", 0, 1),
    "pixel_status": Variable("1", "0 usable, 1 no signal, 2 saturated, 3 missing, 4 hot, 5 masked", 0, 5),
    # test folder
    "counts": Variable("count", "raw signal of the spectrometer", nan_allowed=True),
    "background_counts": Variable("count", "raw signal in the dark", nan_allowed=True),
    "saturated": Variable("1", "1 where the converter of the spectrometer was at its limit", 0, 1),
    "spectral_radiance": Variable(RADIANCE, "measured spectral radiance, L_m", nan_allowed=True),
    "electric_power": Variable("W", "electric power of the torch", 0, 1e9, nan_allowed=True),
    # experiment
    "reference_signal": Variable("A", "mean signal of the reference window, S_ref"),
    "reference_signal_uncertainty": Variable("A", "its standard uncertainty", 0),
    "corrected_signal": Variable("A", "signal of the surface alone, S_corr", nan_allowed=True),
    "corrected_signal_uncertainty": Variable("A", "its standard uncertainty", 0, nan_allowed=True),
    "surface_share": Variable("1", "corrected over measured signal", nan_allowed=True),
    "measured_temperature": Variable(
        "K", "temperature read from the signals as they are, T_meas", 100, 1e4, nan_allowed=True
    ),
    "measured_temperature_uncertainty": Variable("K", "its standard uncertainty", 0, 1e4, nan_allowed=True),
    "measured_status": Variable("1", "status of the measured temperature, see flag_meanings", -1, 9),
    "corrected_temperature": Variable(
        "K", "temperature read from the corrected signals, T_corr", 100, 1e4, nan_allowed=True
    ),
    "corrected_temperature_uncertainty": Variable("K", "its standard uncertainty", 0, 1e4, nan_allowed=True),
    "corrected_status": Variable("1", "status of the corrected temperature, see flag_meanings", -1, 9),
    "surface_temperature": Variable("K", "surface temperature, joint estimate", 100, 1e4, nan_allowed=True),
    "surface_temperature_uncertainty": Variable("K", "its standard uncertainty", 0, 1e4, nan_allowed=True),
    "surface_temperature_interval": Variable(
        "K", "ends of its 95 % interval, 2.5 and 97.5 %", 1, 1e5, nan_allowed=True
    ),
    "estimate_status": Variable("1", "status of the joint estimate, see flag_meanings", -1, 9),
    "estimated_surface_share": Variable("1", "estimated share of the surface in a signal", 0, 1, True),
    "gas_amplitude": Variable("1", "gas light over that right after injection", 0, 1e4),
    "gas_amplitude_uncertainty": Variable("1", "its standard uncertainty", 0, 1e4),
    "gas_current": Variable("A", "signal of the gas right after injection, joint estimate"),
    "gas_current_uncertainty": Variable("A", "its standard uncertainty", 0, 1e3),
    "estimated_emittance": Variable("1", "grey emittance of the surface, joint estimate", 0, 10),
    "estimated_emittance_uncertainty": Variable("1", "its standard uncertainty", 0, 10),
    "gain_correction": Variable("1", "relative change of the absolute sensitivity", -1, 10),
    "gain_correction_uncertainty": Variable("1", "its standard uncertainty", 0, 10),
    "whitened_residual": Variable("1", "signal less model over the noise", nan_allowed=True),
    "reference_radiance": Variable(RADIANCE, "spectral radiance of the gas, L_ref", nan_allowed=True),
    "corrected_radiance": Variable(RADIANCE, "spectral radiance of the surface, L_corr", nan_allowed=True),
    "radiance_noise": Variable(
        RADIANCE, "standard deviation of the noise of the corrected radiance", 0, nan_allowed=True
    ),
    "normalised_radiance": Variable("1", "corrected radiance over its value at the pivot", nan_allowed=True),
    "normalised_fit": Variable("1", "black body at T_sp over its value at the pivot", nan_allowed=True),
    "spectrometer_temperature": Variable(
        "K", "temperature of the normalised Planck fit, T_sp", 100, 1e4, nan_allowed=True
    ),
    "spectrometer_temperature_uncertainty": Variable(
        "K", "its standard uncertainty", 0, 1e4, nan_allowed=True
    ),
    "scaled_temperature": Variable(
        "K", "temperature of the Planck fit with a free scale", 100, 1e4, nan_allowed=True
    ),
    "scaled_temperature_uncertainty": Variable("K", "its standard uncertainty", 0, 1e4, nan_allowed=True),
    "apparent_emittance": Variable("1", "scale of the Planck fit", nan_allowed=True),
    "apparent_emittance_uncertainty": Variable("1", "its standard uncertainty", 0, nan_allowed=True),
    "signal_to_noise": Variable(
        "1", "corrected radiance at the pivot over its uncertainty", nan_allowed=True
    ),
    "spectrum_status": Variable("1", "status of the temperatures of the spectrum, see flag_meanings", -1, 9),
    # sight line
    "excitation_temperature": Variable(
        "K", "temperature of vibration, excitation and electrons where it is not the other", 100, 3e4
    ),
    "rotational_temperature": Variable("K", "temperature of molecular rotation, as given", 100, 3e4),
    "vibrational_temperature": Variable("K", "temperature of molecular vibration, as given", 100, 3e4),
    "electron_temperature": Variable("K", "temperature of the free electrons, as given", 100, 3e4),
    "path_distance": Variable("m", "distance from the surface along the line of sight", 0, 100),
    "axial_position": Variable("m", "axial position, 0 at the torch back wall", -100, 100),
    "radial_position": Variable("m", "distance from the jet axis", 0, 100),
    "number_density": Variable("m-3", "number density", 0, 1e28),
    "ray_angle": Variable("rad", "angle between the ray and the surface normal", 0, np.pi / 2),
    "ray_weight": Variable("1", "share of the ray in the hemispherical mean; 0 for the mirrored ray", 0, 1),
    "ray_distance": Variable("m", "distance from the surface along the ray", 0, 100),
    "ray_temperature": Variable("K", "temperature along the ray", 100, 3e4),
    "ray_pressure": Variable("Pa", "absolute pressure along the ray", 1, 1e7),
    "ray_number_density": Variable("m-3", "number density along the ray", 0, 1e28),
    # claims
    "claim": Variable("", "short name of the claim"),
    "section": Variable("", "section of the paper"),
    "statement": Variable("", "what the paper says"),
    "unit": Variable("", "unit of value and printed range"),
    "printed": Variable("", "range that counts as the printed value"),
    "verdict": Variable("", "how value and printed range compare"),
    "remark": Variable("", "how it was measured here, and why it may differ"),
    "basis": Variable("", "what the value rests on: simulation, synthetic data, nothing"),
    "value": Variable("1", "value of this chain, in the unit of the claim", nan_allowed=True),
    "printed_low": Variable("1", "lower end of the printed range, in the unit of the claim"),
    "printed_high": Variable("1", "upper end of the printed range, in the unit of the claim"),
}

STUDY_DIMS = ("numerical_power", "chamber_pressure", "mass_flow_rate", "emittance", "sightline_angle")

DATASETS = {
    "gas": {
        "pressure": ("pressure",),
        "temperature": ("temperature",),
        "species": ("species",),
        "mole_fraction": ("pressure", "temperature", "species"),
        **{
            name: ("pressure", "temperature")
            for name in (
                "density",
                "enthalpy",
                "heat_capacity",
                "viscosity",
                "thermal_conductivity",
                "electrical_conductivity",
            )
        },
    },
    "net_emission": {
        "pressure": ("pressure",),
        "temperature": ("temperature",),
        "net_emission": ("pressure", "temperature"),
    },
    "flow": {
        "mesh": (),
        "node_z": ("node",),
        "node_r": ("node",),
        "face_node": ("face", "corner"),
        "face_midnode": ("face", "corner"),
        **{
            name: ("node",)
            for name in ("temperature", "pressure", "axial_velocity", "radial_velocity", "joule_heating")
        },
        **{
            name: ()
            for name in (
                "numerical_power",
                "chamber_pressure",
                "mass_flow_rate",
                "coil_current",
                "equivalent_resistance",
                "mass_imbalance",
                "energy_imbalance",
                "radiated_power?",
            )
        },
        "azimuthal_velocity?": ("node",),
        "temperature_error?": ("node",),
        # Only the cold start: meshes that the other conditions need, one after the other.
        "solver_mesh_factor?": ("solver_mesh",),
        **{f"solver_vertex_{name}?": ("solver_vertex",) for name in ("mesh", "z", "r")},
        **{f"solver_triangle_{name}?": ("solver_face",) for name in ("mesh", "flow")},
        "solver_triangle?": ("solver_face", "corner"),
        "boundary": ("boundary",),
        **{
            name: ("boundary",)
            for name in ("boundary_mass_flow", "boundary_enthalpy_flow", "boundary_heat_flow")
        },
        **{
            name: ("iteration",)
            for name in ("residual_norm", "velocity_change", "temperature_change", "cfl_number")
        },
    },
    "claims": {
        name: ("claim",)
        for name in (
            "claim",
            "section",
            "statement",
            "unit",
            "printed",
            "verdict",
            "remark",
            "basis",
            "value",
            "printed_low",
            "printed_high",
        )
    },
    "gas_signal": {
        "condition": ("condition",),
        "band": ("band",),
        "gas_signal": ("condition", "band"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "visibility": {
        "condition": ("condition",),
        "band": ("band",),
        "object_temperature": ("object_temperature",),
        "visibility_level": ("visibility_level",),
        "visibility_factor": ("condition", "band", "object_temperature"),
        "visibility_limit": ("visibility_level", "condition", "band"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "apparent_temperature": {
        "condition": ("condition",),
        "object_temperature": ("object_temperature",),
        "apparent_temperature": ("condition", "object_temperature"),
        "relative_error": ("condition", "object_temperature"),
        "reading_status": ("condition", "object_temperature"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "error_map": {
        "condition": ("condition",),
        "emittance": ("emittance",),
        "object_temperature": ("object_temperature",),
        "relative_error": ("condition", "emittance", "object_temperature"),
        "error_limit": ("condition", "emittance"),
        "limit_status": ("condition", "emittance"),
        "numerical_power": ("condition",),
    },
    "transient": {
        "condition": ("condition",),
        "time": ("time",),
        "object_temperature_history": ("time",),
        "apparent_temperature": ("condition", "time"),
        "reading_status": ("condition", "time"),
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
    },
    "study_signal": {
        "band": ("band",),
        "gas_signal": ("band",),
        **{
            name: ()
            for name in (
                "numerical_power",
                "chamber_pressure",
                "mass_flow_rate",
                "sightline_angle",
                "flow_status",
                "peak_temperature",
            )
        },
    },
    "study": {
        **{name: (name,) for name in (*STUDY_DIMS, "band", "object_temperature")},
        "flow_status": STUDY_DIMS[:3],
        "gas_signal": (*STUDY_DIMS[:3], "sightline_angle", "band"),
        "peak_temperature": (*STUDY_DIMS[:3], "sightline_angle"),
        **{name: STUDY_DIMS for name in ("study_status", "error_limit", "study_limit_status")},
        **{name: (*STUDY_DIMS, "object_temperature") for name in ("relative_error", "study_reading_status")},
        "visibility_factor": (*STUDY_DIMS, "band", "object_temperature"),
    },
    "surface_radiance": {
        "object_temperature": ("object_temperature",),
        "wavelength": ("wavelength",),
        "surface_radiance": ("object_temperature", "wavelength"),
    },
    "sightline": {
        "path_distance": ("path_distance",),
        "species": ("species",),
        "temperature": ("path_distance",),
        "pressure": ("path_distance",),
        "number_density": ("species", "path_distance"),
        "excitation_temperature?": ("path_distance",),
        "rotational_temperature?": ("path_distance",),
        "vibrational_temperature?": ("path_distance",),
        "electron_temperature?": ("path_distance",),
        "axial_position?": ("path_distance",),
        "radial_position?": ("path_distance",),
        "temperature_error?": ("path_distance",),
    },
    "surface_view": {
        "species": ("species",),
        "ray_angle": ("ray",),
        "ray_weight": ("ray",),
        "ray_distance": ("ray", "node"),
        "ray_temperature": ("ray", "node"),
        "ray_pressure": ("ray", "node"),
        "ray_number_density": ("ray", "species", "node"),
    },
    "reflected_radiance": {
        "wavelength": ("wavelength",),
        "wavelength_slit": ("wavelength_slit",),
        "component": ("component",),
        "band": ("band",),
        "reflection": ("reflection",),
        "incident_radiance": ("reflection", "wavelength"),
        "incident_radiance_component": ("reflection", "component", "wavelength"),
        "incident_radiance_slit": ("reflection", "wavelength_slit"),
        "incident_signal": ("reflection", "band"),
        "ray_angle": ("ray",),
        "ray_weight": ("ray",),
        "ray_signal": ("ray", "band"),
    },
    "reflection": {
        **{
            name: (name,)
            for name in ("surface", "correction", "condition", "emittance", "object_temperature")
        },
        "reflection": ("reflection",),
        "band": ("band",),
        "relative_error": ("surface", "correction", "condition", "emittance", "object_temperature"),
        **{
            name: ("surface", "correction", "condition", "emittance")
            for name in ("error_limit", "limit_status", "neglect_limit")
        },
        "incident_signal": ("condition", "reflection", "band"),
        "gas_signal": ("condition", "band"),
        "numerical_power": ("condition",),
    },
    "gas_spectra": {
        **{name: (name,) for name in ("condition", "state", "component", "reflection", "wavelength")},
        "binned_radiance": ("condition", "state", "component", "wavelength"),
        "incident_binned": ("condition", "reflection", "wavelength"),
        "wavelength_edge": ("edge",),
        "component_uncertainty": ("component",),
        "numerical_power": ("condition",),
    },
    "band_design": {
        **{name: (name,) for name in ("design", "error_source", "perturbation", "condition", "emittance")},
        **{
            name: ("design",)
            for name in (
                "design_kind",
                "design_detector",
                "design_shape",
                "total_error",
                "ratio_sensitivity",
                "design_score",
            )
        },
        **{name: ("design", "design_band") for name in ("band_centre", "band_width", "band_weight")},
        "error_by_source": ("design", "error_source"),
        **{name: ("design", "condition") for name in ("design_limit", "design_gain")},
        "gain_change": ("design", "perturbation", "condition"),
        "map_limit": ("design", "condition", "emittance"),
        **{
            name: ("candidate",)
            for name in ("candidate_sensitivity", "candidate_limit", "candidate_score", "candidate_on_front")
        },
        **{name: ("candidate", "pair") for name in ("candidate_centre", "candidate_width")},
        "numerical_power": ("condition",),
    },
    "trust": {
        **{name: (name,) for name in ("condition", "setup", "trust_level", "surface")},
        **{
            name: ("condition", "surface", "setup", "trust_level")
            for name in ("trust_temperature", "trust_time")
        },
        "own_uncertainty": ("setup",),
        "numerical_power": ("condition",),
    },
    "gas_variations": {
        "core_change": ("core_change",),
        "core_radiance": ("core_change", "wavelength_slit"),
        "variation": ("variation",),
        "variation_amplitude": ("variation", "level"),
        "varied_radiance": ("variation", "level", "wavelength_slit"),
        "addition": ("addition",),
        "added_radiance": ("addition", "wavelength_slit"),
        "wavelength_slit": ("wavelength_slit",),
    },
    "residual_map": {
        "time_bin": ("time_bin",),
        "time_edge": ("time_bin", "bound"),
        "model": ("model",),
        "wavelength_bin?": ("wavelength_bin",),
        "wavelength_edge?": ("wavelength_bin", "bound"),
        "measured_radiance?": ("time_bin", "wavelength_bin"),
        "modelled_radiance?": ("model", "time_bin", "wavelength_bin"),
        "radiance_residual?": ("model", "time_bin", "wavelength_bin"),
        "measured_signal?": ("band", "time_bin"),
        "modelled_signal?": ("model", "band", "time_bin"),
        "signal_residual?": ("model", "band", "time_bin"),
    },
    "diagnosis_temperature": {
        "time_bin": ("time_bin",),
        "paper_temperature": ("time_bin",),
        **{
            f"{kind}_temperature{end}": ("time_bin",)
            for kind in ("base", "extended")
            for end in ("", "_low", "_high")
        },
    },
    "spectrum": {
        "wavelength": ("wavelength",),
        "component": ("component",),
        "gas_radiance": ("wavelength",),
        "gas_radiance_component": ("component", "wavelength"),
        "optical_depth": ("wavelength",),
        "wavelength_slit": ("wavelength_slit",),
        "gas_radiance_slit": ("wavelength_slit",),
        "gas_radiance_component_slit": ("component", "wavelength_slit"),
    },
    "radiation": {
        "wavelength": ("wavelength",),
        "component": ("component",),
        "gas_radiance": ("wavelength",),
        "gas_radiance_component": ("component", "wavelength"),
        "component_uncertainty?": ("component",),
        "optical_depth": ("wavelength",),
        "wavelength_slit": ("wavelength_slit",),
        "gas_radiance_slit": ("wavelength_slit",),
        "gas_radiance_component_slit": ("component", "wavelength_slit"),
        "band": ("band",),
        "band_signal": ("band",),
        "band_signal_thin": ("band",),
        "band_signal_gridless": ("band",),
    },
    "response": {
        "wavelength": ("wavelength",),
        "responsivity_wide": ("wavelength",),
        "responsivity_narrow": ("wavelength",),
    },
    "ratio_curve": {
        "sensitivity_ratio": (),
        "calibration_temperature": ("calibration_temperature",),
        "calibration_ratio": ("calibration_temperature",),
        "instrument_range": ("bound",),
    },
    "calibration_points": {
        name: ("calibration_point",) for name in ("source_temperature", "signal_wide", "signal_narrow")
    },
    "calibration": {
        **{name: () for name in ("sensitivity_ratio", "sensitivity_ratio_uncertainty")},
        "band": ("band",),
        "absolute_sensitivity": ("band",),
        "absolute_sensitivity_uncertainty": ("band",),
        **{
            name: ("calibration_point",)
            for name in ("source_temperature", "point_ratio", "model_residual", "fit_residual")
        },
        **{
            name: ("calibration_temperature",)
            for name in (
                "calibration_temperature",
                "calibration_ratio",
                "fitted_ratio",
                "temperature_uncertainty",
            )
        },
        "fit_coefficient": ("fit_power",),
        "fit_covariance": ("fit_power", "other_fit_power"),
        "fit_range": ("bound",),
        "instrument_range": ("bound",),
    },
    "spectrometer_counts": {
        "wavelength": ("wavelength",),
        "calibration_counts": ("wavelength",),
        "calibration_background": ("wavelength",),
    },
    "spectrometer_exposures": {
        "wavelength": ("wavelength",),
        "exposure_counts": ("exposure", "wavelength"),
        "exposure_dark": ("exposure", "wavelength"),
        "exposure_time": ("exposure",),
        "source_radiance": ("wavelength",),
        "source_radiance_uncertainty": ("wavelength",),
    },
    "spectrometer_calibration": {
        "calibration_factor_common?": ("wavelength",),
        "dark_scale?": ("exposure",),
        "linearity_coefficient?": ("linearity_power",),
        "masked_pixel?": ("masked",),
        **{
            name: ("wavelength",)
            for name in (
                "wavelength",
                "calibration_factor",
                "calibration_factor_uncertainty",
                "pixel_status",
            )
        },
        "source_temperature": (),
        "source_temperature_uncertainty": (),
    },
    "test": {
        "time?": ("time",),
        "signal_wide?": ("time",),
        "signal_narrow?": ("time",),
        "electric_power?": ("time",),
        "chamber_pressure?": ("time",),
        "mass_flow_rate?": ("time",),
        "spectrum_time?": ("spectrum_time",),
        "wavelength?": ("wavelength",),
        "spectral_radiance?": ("spectrum_time", "wavelength"),
        "counts?": ("spectrum_time", "wavelength"),
        "saturated?": ("spectrum_time", "wavelength"),
        "background_counts?": ("wavelength",),
    },
    "pyrometer_correction": {
        "time": ("time",),
        "band": ("band",),
        "signal_wide": ("time",),
        "signal_narrow": ("time",),
        "reference_signal": ("band",),
        "reference_signal_uncertainty": ("band",),
        "corrected_signal": ("band", "time"),
        "corrected_signal_uncertainty": ("band", "time"),
        "surface_share": ("band", "time"),
        **{
            name: ("time",)
            for name in (
                "measured_temperature",
                "measured_temperature_uncertainty",
                "measured_status",
                "corrected_temperature",
                "corrected_temperature_uncertainty",
                "corrected_status",
                "relative_error",
            )
        },
        "instrument_range": ("bound",),
        "fit_range": ("bound",),
    },
    "joint_estimate": {
        "time": ("time",),
        "band": ("band",),
        **{
            name: ("time",)
            for name in (
                "surface_temperature",
                "surface_temperature_uncertainty",
                "estimate_status",
                "gas_amplitude",
                "gas_amplitude_uncertainty",
            )
        },
        "surface_temperature_interval": ("bound", "time"),
        "estimated_surface_share": ("band", "time"),
        "whitened_residual": ("band", "time"),
        **{
            name: ("band",)
            for name in (
                "gas_current",
                "gas_current_uncertainty",
                "gain_correction",
                "gain_correction_uncertainty",
            )
        },
        "estimated_emittance": (),
        "estimated_emittance_uncertainty": (),
    },
    "spectrometer_correction": {
        "spectrum_time": ("spectrum_time",),
        "wavelength": ("wavelength",),
        "pixel_status": ("wavelength",),
        "reference_radiance": ("wavelength",),
        **{
            name: ("spectrum_time", "wavelength")
            for name in (
                "spectral_radiance",
                "corrected_radiance",
                "radiance_noise",
                "normalised_radiance",
                "normalised_fit",
            )
        },
        **{
            name: ("spectrum_time",)
            for name in (
                "spectrometer_temperature",
                "spectrometer_temperature_uncertainty",
                "scaled_temperature",
                "scaled_temperature_uncertainty",
                "apparent_emittance",
                "apparent_emittance_uncertainty",
                "signal_to_noise",
                "spectrum_status",
            )
        },
    },
}


def _optional(contract):
    return {f"{name.rstrip('?')}?": dims for name, dims in DATASETS[contract].items()}


# A study holds a flow or only the word that there is none.
DATASETS["study_flow"] = _optional("flow") | {
    **{name: () for name in ("numerical_power", "chamber_pressure", "mass_flow_rate", "flow_status")}
}
# Conditions of a study that have no flow are NaN, whatever the variable allows elsewhere.
WITH_GAPS = {"study_signal", "study"}

# What `plasmapyro correct` writes: of each instrument that the test holds.
DATASETS["correction"] = _optional("pyrometer_correction") | _optional("spectrometer_correction")


def _breaches_of(found, name, dims, rule, gaps):
    if found.dims != dims:
        yield f"{name}: dims {found.dims}, expected {dims}"
    if rule.units == "":
        if found.dtype.kind not in "OUST":
            yield f"{name}: must be text, is {found.dtype}"
        return
    if found.attrs.get("units") != rule.units:
        yield f"{name}: units {found.attrs.get('units')!r}, expected {rule.units!r}"
    values = np.asarray(found.values)
    if values.dtype.kind not in "fiu":
        yield f"{name}: must be numbers, is {values.dtype}"
        return
    if not (rule.nan_allowed or gaps) and np.isnan(values).any():
        yield f"{name}: NaN not allowed"
    outside = (values < rule.low) | (values > rule.high)
    if outside.any():
        yield f"{name}: {values[outside].flat[0]:g} {rule.units} outside [{rule.low:g}, {rule.high:g}]"


def check(dataset, contract):
    """Raise ContractError naming all breaches of `contract` in `dataset`; return the dataset."""
    breaches = []
    for key, dims in DATASETS[contract].items():
        name = key.rstrip("?")
        if name in dataset.variables:
            breaches += _breaches_of(dataset[name], name, dims, VARIABLES[name], contract in WITH_GAPS)
        elif key == name:
            breaches.append(f"{name}: missing")
    if breaches:
        raise ContractError(f"not a valid '{contract}' dataset:\n  " + "\n  ".join(breaches))
    return dataset


def label(dataset, contract):
    """Return a copy of `dataset` whose variables carry the registered units, long and standard names."""
    dataset = dataset.copy()
    for key in DATASETS[contract]:
        name = key.rstrip("?")
        if name in dataset.variables:
            rule = VARIABLES[name]
            attributes = {"long_name": rule.long_name}
            if rule.units:
                attributes["units"] = rule.units
            if rule.standard_name:
                attributes["standard_name"] = rule.standard_name
            dataset[name].attrs.update(attributes)
    return dataset
