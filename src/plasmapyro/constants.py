"""Physical constants, SI, from the CODATA set shipped with the locked scipy."""

from scipy.constants import Avogadro as AVOGADRO
from scipy.constants import R as MOLAR_GAS
from scipy.constants import Rydberg as RYDBERG
from scipy.constants import atomic_mass as ATOMIC_MASS
from scipy.constants import c as LIGHT_SPEED
from scipy.constants import e as ELEMENTARY_CHARGE
from scipy.constants import electron_volt as ELECTRON_VOLT
from scipy.constants import epsilon_0 as VACUUM_PERMITTIVITY
from scipy.constants import h as PLANCK
from scipy.constants import k as BOLTZMANN
from scipy.constants import m_e as ELECTRON_MASS
from scipy.constants import mu_0 as VACUUM_PERMEABILITY
from scipy.constants import physical_constants

BOHR_RADIUS = physical_constants["Bohr radius"][0]  # [m]
FIRST_RADIATION = 2 * PLANCK * LIGHT_SPEED**2  # [W m2 sr-1]
SECOND_RADIATION = PLANCK * LIGHT_SPEED / BOLTZMANN  # [m K]
STANDARD_ATMOSPHERE = 101325.0  # [Pa], exact by definition
