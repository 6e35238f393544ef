"""Several pads at once: cavities side by side in one mould, several moulds in one job."""
