"""How long commands and parts take."""
