"""Files of traces and parameters beside a report."""
