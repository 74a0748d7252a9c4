"""What a reader of the results sees first: ten claims, and which study stands for which figure of the papers."""

# Study, and words that one of its claims has: its value and verdict are those of the rows.
HEADLINES = (
    ("fig14_single_inclusion", "DEM default, 100000 particles, mean of its packings: worst error of any contrast"),
    ("fig14_single_inclusion", "FEM, P2 on curved elements of 0.04 L: worst error of any contrast"),
    ("fig14_single_inclusion", "FFT scalar CG, 128^3 laminate voxels: worst error of any contrast"),
    ("many_inclusions", "DEM, 8000000 elements: error"),
    ("fig08_sphere_field", "Laguerre, 1e+06 particles, 10 s: largest error"),
    ("fig03_calibration", "1e5 particles, as in the paper: C_t"),
    ("time_integrators", "particle-steps per second over whole steps of LAMMPS with its usual"),
    ("estimates", "DEM: share of exact conductivities inside of the interval"),
    ("brackets", "Exact values outside of their brackets, of"),
    ("hard_cases", "Silently wrong by the main methods"),
)

HADDAD = "Haddad et al., Int. J. Thermal Sciences 164 (2021) 106799"
TERREROS = "Terreros, Iordanoff, Charles, Comput. Mater. Sci. 69 (2013) 46"
NETWORK = "The paper's network, "
TABLE_2 = "As in the paper, "
# Paper, what of it, the study that does the same, and words of the claims that hold the paper's own network, or its own
# rule, to what the paper prints; or why there are none.
FIGURES = (
    (HADDAD, "Fig. 3", "fig03_calibration", ("C_t off the printed", "lsa packings, as in the paper")),
    (HADDAD, "calibration, all it prints at once", "ct_search", ("All that is printed at once",)),
    (HADDAD, "Fig. 5, Table 1", "fig05_slab", ("Contacts, temperatures in centres as in the paper",)),
    (HADDAD, "Fig. 7", "fig07_sphere", ("network as the paper has it, 1e5",)),
    (HADDAD, "Fig. 8", "fig08_sphere_field", ("beside the paper's", "whose mean error is largest")),
    (HADDAD, "Figs. 10 to 12", "fig10_halo", ("Paper's 27, 5, 2 % at once", "10000 particles and more: largest CoV")),
    (HADDAD, "Fig. 14", "fig14_single_inclusion", (NETWORK + "150000 particles, the best",)),
    (HADDAD, "Figs. 15 and 16, Table 2", "fig15_16_fields", (TABLE_2,)),
    (HADDAD, "Fig. 17", "fig17_etc", (NETWORK,)),
    (HADDAD, "Fig. 18, Table 3", "fig18_fields", (NETWORK,)),
    (HADDAD, "Table 3, its arrangement", "table3_search", ("Looks whose",)),
    (HADDAD, "section 5 at full size", "many_inclusions", "its own network of as many particles: Figs. 17 and 18"),
    (HADDAD, "zeta_2, left out as too costly", "zeta2", "it prints no value"),
    (HADDAD, "7 % to experiment", "resistance", "not reproducible: the experiment's values are not printed"),
    (TERREROS, "section 4, Table 1", "table1_platonic", ("largest difference from what is printed",)),
    (TERREROS, "Fig. 10", "fig10_beam", "curves alone are printed"),
    (TERREROS, "Figs. 12 to 15", "fig12_15_sheet", ("Platonic, 20000 particles: dispersion over packings",)),
)
