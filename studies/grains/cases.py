"""What the study looks at; light, since every listing of studies loads it."""

KINDS = ("sc", "bcc", "fcc")
CONTRASTS = (10.0, 100.0, 1000.0)
# Between surfaces, over the radius; of contacts that of the disc.
GAPS = (0.003, 0.03, 0.1, 0.3)
CONTACTS = (0.02, 0.05, 0.1, 0.3)
FRACTIONS, REALISATIONS = (0.4, 0.55), (0, 1, 2)
# Spheres of a bed; largest radius over the smallest; least distance of their surfaces over the mean diameter.
SPHERES, RATIO, APART = 50, 1.5, 0.01
# Contrasts from here on are the law's, and gaps up to here.
GOOD, NARROW = 100.0, 0.03
