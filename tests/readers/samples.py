"""Small files of our own making in the dialects of the instruments."""

import numpy as np

ENGLISH = """SpectraSuite Data File
++++++++++++++++++++++++++++++++++++
Date: Wed Feb 13 09:53:{second:02d} EET 2013
User: somebody
Dark Spectrum Present: No
Reference Spectrum Present: No
Number of Sampled Component Spectra: 1
Spectrometers: MAYP00000
Integration Time (usec): 600000 (MAYP00000)
Spectra Averaged: 2 (MAYP00000)
Boxcar Smoothing: 0 (MAYP00000)
Correct for Electrical Dark: No (MAYP00000)
Strobe/Lamp Enabled: No (MAYP00000)
Correct for Detector Non-linearity: No (MAYP00000)
Correct for Stray Light: No (MAYP00000)
Number of Pixels in Processed Spectrum: {pixels}
>>>>>Begin Processed Spectral Data<<<<<
{body}>>>>>End Processed Spectral Data<<<<<
"""
SPANISH = """Fichero De Datos De SpectraSuite
++++++++++++++++++++++++++++++++++++
Fecha: Wed Feb 13 09:53:{second:02d} CEST 2013
Usuario: alguien
Presente Oscuro Del Espectro: No
Muestreados de los componentes de N\u00famero de espectros: 1
Espectr\u00f3metros: JAZA0000
Tiempo de integraci\u00f3n (usec): 600000 (JAZA0000)
Promedio de Espectros Hechos un: 2 (JAZA0000)
P\u00e1rrafo de de Corregir del la del del de El\u00e9ctrica del obscuridad: No (JAZA0000)
Estrobo/L\u00e1mpara Permitido: S\u00ed (JAZA0000)
Correct for Detector Non-linearity: No (JAZA0000)
Procesado del espectro de N\u00famero de pixeles en: {pixels}
>>>>> Comienza Data<<<<< Espectral Procesado Del EL
{body}>>>>> Data<<<<< Espectral Procesado Extremo
"""
OCEANVIEW = """Data from lamp_00001.txt Node
\rDate: Wed Feb 13 09:53:{second:02d} EET 2013
User: somebody
Spectrometer: MAYP000000
Trigger mode: 0
Integration Time (sec): 6{sign}000000E-1
Scans to average: 2
Electric dark correction enabled: false
Nonlinearity correction enabled: false
Boxcar width: 0
XAxis mode: Wavelengths
Stop averaging: false
Number of Pixels in Spectrum: {pixels}
>>>>>Begin Spectral Data<<<<<
{body}"""
JAZ = """Jaz Data File
++++++++++++++++++++++++++++++++++++
Date: Wed Feb 13 09:53:{second:02d} 2013
User: jaz
Dark Spectrum Present: Yes
Spectrometers: JAZA0000
Integration Time (usec): 600000 (JAZA0000)
Spectra Averaged: 2 (JAZA0000)
Correct for Electrical Dark: No (JAZA0000)
Correct for Detector Non-linearity: No (JAZA0000)
Number of Pixels in Processed Spectrum: {pixels}
>>>>>Begin Processed Spectral Data<<<<<
W\tD\tR\tS\tP
{body}>>>>>End Processed Spectral Data<<<<<
"""
FORMS = {  # name -> (template, decimal sign, line end, encoding, number format)
    "spectrasuite": (ENGLISH, ".", "\r\n", "utf-8", "{:.2f}"),
    "spectrasuite comma": (ENGLISH, ",", "\n", "utf-8", "{:.2f}"),
    "spanish latin-1": (SPANISH, ",", "\r\n", "latin-1", "{:.3f}"),
    "oceanview": (OCEANVIEW, ".", "\n", "utf-8", "{:.6E}"),
    "oceanview comma": (OCEANVIEW, ",", "\n", "utf-8", "{:.3f}"),
    "oceanview utf-16": (OCEANVIEW, ".", "\n", "utf-16", "{:.3f}"),
    "jaz": (JAZ, ".", "\n", "utf-8", "{:.6f}"),
}
WAVELENGTH = np.round(np.linspace(750.0, 790.0, 24), 2)  # [nm] in air
COUNTS = np.round(2200 + 40 * np.arange(24.0), 1)
DARK = np.round(2180 + np.arange(24.0) % 3, 1)


def spectrum(form, counts=COUNTS, second=48, wavelength=WAVELENGTH):
    """Bytes of one spectrum file in a dialect of `FORMS`."""
    template, sign, end, encoding, number = FORMS[form]
    rows = []
    for i, (w, c) in enumerate(zip(wavelength, counts, strict=True)):
        cells = [w, DARK[i], 1.0, c, 0.5] if form == "jaz" else [w, c]
        rows.append("\t".join(number.format(cell).replace(".", sign) for cell in cells))
    words = template.format(
        second=second, sign=sign, pixels=len(rows), body="".join(row + "\n" for row in rows)
    )
    return words.replace("\n", end).encode(encoding)


ATTRIBUTES = """attributes:
  origin: measured
  condition: 90kW
  injection_time: 0.0
  plasma_off_time: 100.0
  reference_window: [0.0, 5.0]
  emittance: 0.85
  emittance_uncertainty: 0.05
  window_transmittance_pyrometer: 0.9
  window_transmittance_spectrometer: 0.9
  pyrometer_integration_time: 0.01
  spectrometer_fwhm: 1.5e-9
"""
CSV = """pyrometer:
  columns:
    time: {name: t, unit: s}
    signal_wide: {name: S1, unit: nA}
    signal_narrow: {name: S2, unit: nA}
"""
SPECTRA = """spectrometer:
  quantity: counts
  background: dark.txt
  time: {from: order, first: 0.5, period: 1.0}
"""
MARATHON = """pyrometer:
  format: marathon
"""


def table(rows=20, header="t,S1,S2"):
    """Text of a pyrometer table."""
    return header + "\n" + "".join(f"{i:.1f},{50 + i:.2f},{30 + i / 2:.2f}\n" for i in range(rows))


def log(rows=20, tail="S1.000 I029"):
    """Text of a burst log with a time of day before each string."""
    return "".join(
        f"14:02:{10 + i:02d}.50 UC T{1200 + i:04d} Q{800 + i:08.3f} R{300 + i / 2:08.3f} {tail}\n"
        for i in range(rows)
    )


def folder(place, parts, **files):
    """A test folder: `parts` of test.yaml and files by name (a dot written as two underscores)."""
    place.mkdir(parents=True, exist_ok=True)
    (place / "test.yaml").write_text(ATTRIBUTES + parts, encoding="utf-8")
    for name, content in files.items():
        path = place / name.replace("__", ".")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return place


def spectra(place, form, number=3):
    """Put spectrum files and a dark into a test folder."""
    (place / "spectrometer").mkdir(parents=True, exist_ok=True)
    for i in range(number):
        content = spectrum(form, COUNTS + 10 * i, second=40 + 2 * i)
        (place / "spectrometer" / f"frame_{i:04d}.txt").write_bytes(content)
    (place / "dark.txt").write_bytes(spectrum(form, DARK))
    return place
