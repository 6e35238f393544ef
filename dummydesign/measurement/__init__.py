"""Measurement: traces, motions, sensors, campaigns, and the import of what machines write; not what is pressed."""
