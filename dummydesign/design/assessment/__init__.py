"""What a design is worth: pour tolerance, verification, warnings, centring."""
