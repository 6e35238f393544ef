"""Import of files as test machines write them: text, columns, units, signs, contact, presses."""
