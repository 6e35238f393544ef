"""Measurement: traces, motions, sensors, campaigns and the import of what machines write; knows nothing of what "
"is pressed."""
