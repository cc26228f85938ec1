"""Where atoms and molecules radiate: the twin's own short lists, wavelengths in vacuum [nm].

Relative strengths are degeneracy times transition probability unless a list says otherwise.
"""

# Upper level [cm-1] of the strong multiplets between 720 and 1155 nm, with the range they cover.
# Kramida et al., NIST Atomic Spectra Database, https://doi.org/10.18434/T4W30F.
NITROGEN = (
    (742.0, 747.5, 96751.0), (818.0, 825.0, 95510.0), (856.5, 866.5, 97794.0), (867.5, 875.5, 94837.0),
    (903.0, 906.5, 104700.0), (938.0, 947.0, 96833.0), (977.0, 1006.0, 105000.0),
    (1010.0, 1021.0, 104720.0), (1050.0, 1077.0, 105000.0), (1118.0, 1133.0, 103692.0),
)  # fmt: skip
OXYGEN = (
    (776.5, 778.5, 86629.0),
    (844.0, 846.0, 88631.0),
    (926.0, 927.5, 97421.0),
    (1128.0, 1131.0, 97000.0),
)
# N2+ Meinel: the band that shines most in a range, by its upper level [cm-1] above the ground state, from the
# constants of K. P. Huber & G. Herzberg, Constants of Diatomic Molecules (1979). Bands are shaded to the red.
MEINEL = (
    (716.0, 785.0, 16330.0), (785.0, 808.0, 12733.0), (808.0, 832.0, 14546.0), (832.0, 858.0, 16330.0),
    (858.0, 918.0, 18083.0), (918.0, 947.0, 10889.0), (947.0, 977.0, 12733.0), (977.0, 1010.0, 14546.0),
    (1010.0, 1044.0, 16330.0), (1044.0, 1109.0, 18083.0), (1109.0, 1147.0, 9015.0),
    (1147.0, 1156.0, 10889.0),
)  # fmt: skip
# Lines that absorb themselves first: O I, with relative optical depth (gf times lower population at 6000 K).
OXYGEN_DEPTH = ((777.408, 1.0), (777.631, 0.714), (777.753, 0.428), (844.87, 0.45))

# N2 first positive system: (v', wavelength of the origin in air [nm], A [10^3 s-1]). Wavelengths and
# potentials: Laher & Gilmore, J. Phys. Chem. Ref. Data 20, 685 (1991); moment: Laux & Kruger, JQSRT 48.
NITROGEN_BANDS = (
    (0, 1046.6, 42.9), (1, 888.1, 65.2), (2, 773.0, 36.4), (2, 869.3, 46.8), (2, 990.3, 8.8),
    (3, 760.4, 64.4), (3, 851.4, 16.7), (3, 964.5, 20.3), (4, 748.2, 70.9), (4, 940.1, 21.3),
    (4, 1073.6, 5.3), (5, 736.6, 59.2), (5, 817.9, 2.3), (5, 917.1, 14.0), (5, 1040.5, 10.5),
    (6, 725.3, 38.6), (6, 802.2, 12.5), (6, 895.2, 5.3), (6, 1009.5, 12.3), (7, 787.2, 23.2),
    (7, 980.4, 10.2), (7, 1112.1, 6.3), (8, 772.8, 28.8), (8, 952.9, 5.9), (8, 1073.5, 7.8),
    (9, 759.0, 27.5), (9, 835.6, 5.9), (9, 1037.4, 7.2),
)  # fmt: skip
# Term energy of v' = 0 to 9 of N2 B above X [cm-1]: Laher & Gilmore (1991).
NITROGEN_VIBRATION = (59307, 61012, 62688, 64335, 65953, 67543, 69103, 70635, 72138, 73612)

# Impurities: NIST Atomic Spectra Database, as above.
SODIUM_POTASSIUM = ((818.5505, 1.72), (819.7077, 3.42), (766.7009, 4.8), (770.1083, 2.4))
CALCIUM_ION = ((850.036, 0.35), (854.444, 3.15), (866.452, 1.68))
COPPER = ((793.5307, 0.40), (809.4856, 0.75))
RUBIDIUM = ((780.241, 2.0), (794.979, 1.0))
ARGON = (  # degeneracy times A [10^8 s-1], upper level [cm-1]
    (763.721, 1.22, 106237.6), (801.699, 0.464, 105617.3), (810.592, 0.75, 106087.3),
    (811.754, 2.32, 105462.8), (826.679, 0.459, 107496.4), (841.052, 1.12, 107289.7),
    (842.696, 1.08, 105617.3), (852.378, 0.417, 107131.7), (912.547, 0.567, 104102.1),
)  # fmt: skip
# CN red system: (v', head in vacuum [nm], relative strength A q), degraded to the red.
# Brooke et al., Astrophys. J. Suppl. 210, 23 (2014).
CYANOGEN = (
    (0, 1092.8, 1.00), (1, 914.4, 1.00), (2, 787.6, 0.55), (1, 1110.0, 0.12), (2, 937.0, 0.80),
    (3, 806.8, 0.70), (3, 962.0, 0.30), (4, 827.0, 0.50),
)  # fmt: skip
CYANOGEN_QUANTUM = 1790.0  # [cm-1] of the upper state

# Seen in the second order above 910 nm: places in the first order [nm], relative radiance, width [nm].
# N2+ first negative heads, degraded to the violet: Lofthus & Krupenie, J. Phys. Chem. Ref. Data 6 (1977).
SECOND_ORDER = (
    (470.9, 1.0, 2.0), (465.2, 0.7, 2.0), (459.9, 0.4, 2.0), (486.3, 0.25, 0.1), (493.6, 0.12, 0.05),
)  # fmt: skip

# Water vapour: shape of the absorption at low resolution (relative to its maximum at 935 nm), after the
# bands in Rothman et al., JQSRT 277, 107949 (2022) (HITRAN2020).
WATER = (
    (700, 0.0), (715, 0.0), (719, 0.28), (724, 0.25), (731, 0.12), (736, 0.0), (786, 0.0), (790, 0.05),
    (810, 0.03), (813, 0.15), (817, 0.27), (820, 0.17), (824, 0.28), (829, 0.17), (834, 0.1), (840, 0.0),
    (885, 0.0), (892, 0.12), (897, 0.28), (902, 0.3), (907, 0.2), (912, 0.3), (917, 0.22), (922, 0.14),
    (928, 0.35), (931, 0.8), (935, 1.0), (938, 0.8), (942, 0.72), (946, 0.85), (950, 0.75), (955, 0.55),
    (960, 0.42), (965, 0.36), (970, 0.38), (975, 0.28), (980, 0.18), (986, 0.1), (993, 0.03), (1000, 0.0),
    (1080, 0.0), (1090, 0.08), (1100, 0.3), (1106, 0.55), (1111, 0.9), (1116, 1.1), (1121, 1.2), (1126, 1.1),
    (1131, 1.25), (1136, 1.3), (1142, 1.15), (1148, 1.0), (1155, 0.8), (1160, 0.7),
)  # fmt: skip
# O2 A band: band origin, rotational constants of the upper and lower state [cm-1]:
# Krupenie, J. Phys. Chem. Ref. Data 1, 423 (1972).
OXYGEN_BAND = (13120.91, 1.39138, 1.43768)
