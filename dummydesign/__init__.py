"""Design soft dummies of human hand tissue: resin recipe, pad geometry, mould, and the loop with measured data.

Inside the package lengths are in mm, forces in N, times in s and stresses in MPa;
the unit is part of every outward name.
"""

__version__ = "0.1.0"
