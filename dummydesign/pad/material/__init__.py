"""Material laws: hyperelastic energies, Prony series, finite-strain viscoelasticity."""
