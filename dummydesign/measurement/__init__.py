"""Protocol: motions, sensor chain, traces and campaigns; knows nothing of what is pressed."""
