"""Design of the gains: matrix inequalities, certificate, sampled loop, presets."""
