"""Which variables a netCDF file holds, on which dimensions; a name that ends in '?' is optional."""

STUDY_DIMS = ("numerical_power", "chamber_pressure", "mass_flow_rate", "emittance", "sightline_angle")

PROBE_COORDINATES = {name: (name,) for name in ("rates", "recombination", "pitot_radius")}
PROBE_SCALARS = (
    "numerical_power",
    "own_heat_flux",
    "own_pressure",
    "equilibrium_heat_flux",
    "edge_temperature",
    "edge_enthalpy",
    "jet_speed",
)
ERROR_MODES = {
    "error_share?": ("error_mode", "wavelength_slit"),
    "error_system?": ("error_mode",),
    "error_cause?": ("error_mode",),
}


def _budget(axis):
    """What each input adds to the uncertainty of a temperature, see `record.budget`."""
    of_input = ("quantity", "group", "unit", "law", "uncertainty", "freedom")
    return {f"input_{name}": ("input_quantity",) for name in of_input} | {
        "temperature_contribution": ("input_quantity", axis)
    }


def _recommended(axis):
    """The temperature to take away, see `record.recommended`."""
    return {
        **{f"recommended_{name}": (axis,) for name in ("temperature", "temperature_uncertainty", "status")},
        "recommended_temperature_interval": ("bound", axis),
        **_budget(axis),
    }


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
    "probe_readings": {
        **PROBE_COORDINATES,
        **{name: () for name in PROBE_SCALARS},
        "stagnation_heat_flux": ("rates", "recombination"),
        "pitot_pressure": ("pitot_radius",),
        **{
            f"{name}?": ("measurement",)
            for name in (
                "measurement",
                "measured_unit",
                "measured_value",
                "measured_uncertainty",
                "simulated_low",
                "simulated_high",
            )
        },
    },
    "facility": {
        **PROBE_COORDINATES,
        "condition": ("condition",),
        **{name: ("condition",) for name in PROBE_SCALARS},
        "stagnation_heat_flux": ("condition", "rates", "recombination"),
        "pitot_pressure": ("condition", "pitot_radius"),
        "pair": ("pair",),
        **{
            f"pair_{name}": ("pair",)
            for name in ("heat_flux", "flux_uncertainty", "pressure", "pressure_uncertainty")
        },
        "needed_recombination": ("pair", "rates", "pitot_radius"),
        "pair_verdict": ("pair", "rates", "pitot_radius"),
        "heat_left": ("pair", "rates", "pitot_radius", "bound"),
        "momentum_left": ("pair", "rates", "pitot_radius", "bound"),
        "matching_power": ("pair", "pitot_radius"),
        "matching_temperature": ("pair", "pitot_radius"),
        "needed_mixing": ("pair", "rates", "pitot_radius", "bound"),
        "mixed_temperature": ("pair", "rates", "pitot_radius", "bound"),
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
        "chamber_pressure?": ("condition",),
        "sample_emittance": ("condition",),
        "first_of_ladder?": ("condition",),
    },
    "visibility": {
        "condition": ("condition",),
        "band": ("band",),
        "object_temperature": ("object_temperature",),
        "visibility_level": ("visibility_level",),
        "visibility_factor": ("condition", "band", "object_temperature"),
        "visibility_limit": ("visibility_level", "condition", "band"),
        "numerical_power": ("condition",),
        "chamber_pressure?": ("condition",),
        "sample_emittance": ("condition",),
    },
    "apparent_temperature": {
        "condition": ("condition",),
        "object_temperature": ("object_temperature",),
        "apparent_temperature": ("condition", "object_temperature"),
        "relative_error": ("condition", "object_temperature"),
        "reading_status": ("condition", "object_temperature"),
        "numerical_power": ("condition",),
        "chamber_pressure?": ("condition",),
        "sample_emittance": ("condition",),
    },
    "corrected_reading": {
        "time": ("time",),
        "object_temperature": ("object_temperature",),
        "display": ("object_temperature",),
        **{
            name: ("time",)
            for name in (
                "apparent_temperature",
                "surface_temperature",
                "surface_temperature_low",
                "surface_temperature_high",
                "other_temperature",
                "corrected_reading_status",
            )
        },
    },
    "error_map": {
        "condition": ("condition",),
        "emittance": ("emittance",),
        "object_temperature": ("object_temperature",),
        "relative_error": ("condition", "emittance", "object_temperature"),
        "error_limit": ("condition", "emittance"),
        "limit_status": ("condition", "emittance"),
        "numerical_power": ("condition",),
        "chamber_pressure?": ("condition",),
    },
    "transient": {
        "condition": ("condition",),
        "time": ("time",),
        "object_temperature_history": ("time",),
        "apparent_temperature": ("condition", "time"),
        "reading_status": ("condition", "time"),
        "numerical_power": ("condition",),
        "chamber_pressure?": ("condition",),
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
        "chamber_pressure?": ("condition",),
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
    "simulations": {
        **{name: (name,) for name in ("condition", "component", "band", "wavelength_slit")},
        **{name: (name,) for name in ("core_change", "variation", "addition")},
        "numerical_power": ("condition",),
        "sample_emittance": ("condition",),
        "gas_signal": ("condition", "band"),
        "component_uncertainty": ("component",),
        **ERROR_MODES,
        "variation_amplitude": ("condition", "variation", "level"),
        "gas_radiance_slit": ("condition", "wavelength_slit"),
        "gas_radiance_component_slit": ("condition", "component", "wavelength_slit"),
        "core_radiance": ("condition", "core_change", "wavelength_slit"),
        "varied_radiance": ("condition", "variation", "level", "wavelength_slit"),
        "added_radiance": ("condition", "addition", "wavelength_slit"),
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
    "temperature": {"time": ("time",), **_recommended("time")},
    "truth": {"time": ("time",), "surface_temperature": ("time",)},
    "diagnosis_temperature": {
        "time_bin": ("time_bin",),
        **_recommended("time_bin"),
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
        **ERROR_MODES,
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
        "responsivity_wide?": ("wavelength",),
        "responsivity_narrow?": ("wavelength",),
        "band?": ("band",),
        "responsivity?": ("band", "wavelength"),
    },
    "ratio_curve": {
        "sensitivity_ratio?": (),
        "calibration_temperature": ("calibration_temperature",),
        "calibration_ratio?": ("calibration_temperature",),
        "band?": ("band",),
        "calibration_signal?": ("band", "calibration_temperature"),
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
    "radiometer_calibration": {
        "wavelength": ("wavelength",),
        "band": ("band",),
        "responsivity": ("band", "wavelength"),
        "band_sensitivity": ("band",),
        "band_sensitivity_uncertainty": ("band",),
        "band_source_temperature": ("band",),
        "source_temperature_uncertainty": (),
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
        "band?": ("band",),
        "radiometer_time?": ("radiometer_time",),
        **{f"radiometer_{name}?": ("radiometer_time", "band") for name in ("signal", "reading", "setting")},
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
        **_budget("time"),
    },
    "joint_estimate": {
        "time": ("time",),
        "band": ("band",),
        **_budget("time"),
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
    "emissivity_estimate": {
        "spectrum_time": ("spectrum_time",),
        "time": ("time",),
        **_budget("time"),
        "emissivity_wavelength": ("emissivity_wavelength",),
        "spectral_temperature": ("spectrum_time",),
        "spectral_temperature_uncertainty": ("spectrum_time",),
        "spectral_temperature_interval": ("bound", "spectrum_time"),
        "spectral_status": ("spectrum_time",),
        "emissivity": ("spectrum_time", "emissivity_wavelength"),
        "emissivity_interval": ("bound", "spectrum_time", "emissivity_wavelength"),
        "spectral_residual": ("spectrum_time", "emissivity_wavelength"),
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
# Files of the gas of one condition may say which, in attributes: numbers, or text (see `conditions`).
OF_A_CONDITION = ("sightline", "spectrum", "radiation", "gas_variations")
CONDITION = ("numerical_power", "chamber_pressure", "mass_flow_rate", "gas", "flow_settings")
# Conditions of a study that have no flow are NaN, whatever the variable allows elsewhere.
WITH_GAPS = {"study_signal", "study"}

for _name in ("joint_estimate", "emissivity_estimate"):
    DATASETS[_name] = _optional("temperature") | DATASETS[_name]
# What `plasmapyro correct` writes: of each instrument that the test holds, and what to take away.
DATASETS["correction"] = (
    _optional("pyrometer_correction")
    | _optional("spectrometer_correction")
    | _optional("joint_estimate")
    | _optional("emissivity_estimate")
    | _optional("temperature")
)
