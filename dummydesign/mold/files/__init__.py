"""Files of a mould: STEP, meshes, drawings, picture and pour sheet."""
