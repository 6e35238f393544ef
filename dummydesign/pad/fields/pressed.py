"""What is known at every node of a pad that is pressed to one depth, and along its tested face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray

# State of a place on the tested face.
FREE, STICKS, SLIPS = 0, 1, 2
STATES = ("free", "sticks", "slips")


@dataclass(frozen=True)
class Face:
    """The tested face of a pressed pad, from the axis outwards.

    Attributes
    ----------
    node : ndarray of int, shape (n,)
        Its nodes in :class:`Pressed`.
    radius_mm, height_mm : ndarray, shape (n,)
        Where its nodes are now; the height is counted from the base. [mm]
    rest_mm : ndarray, shape (n,)
        Their radii before. [mm]
    pressure_MPa, shear_MPa : ndarray, shape (n,)
        Force of the punch per present area, along the face's normal (pressing is positive) and along the face. [MPa]
    state : ndarray of int, shape (n,)
        0 free, 1 sticks, 2 slips. The contact ends between nodes: the outermost that carries may lie outside it.
    contact_radius_mm : float
        Largest present radius that touches, seen from above; 0 where nothing does. At most the radius of a flat punch:
        the contact has it once it is at a sharp edge, or at the upright side of a filleted punch. [mm]
    """

    node: Array
    radius_mm: Array
    height_mm: Array
    rest_mm: Array
    pressure_MPa: Array
    shear_MPa: Array
    state: Array
    contact_radius_mm: float


@dataclass(frozen=True)
class Pressed:
    """A pad pressed to one depth: a mesh of nine-node quadrilaterals in the (r, z) plane and its fields.

    Attributes
    ----------
    depth_mm, force_N : float
        Depth of the punch and the force that this solve finds there.
    rest_mm, displacement_mm : ndarray, shape (n, 2)
        Nodes before, and where they went; z = 0 is the base, the tested face is up. [mm]
    cells : ndarray of int, shape (m, 9)
        Corners, mid-sides and middle of each cell, in the order of VTK's biquadratic quadrilateral.
    cauchy_MPa : ndarray, shape (n, 4)
        Cauchy stress rr, zz, tt (hoop) and rz, means over the cells at a node. [MPa]
    stretch : ndarray, shape (n, 3)
        Principal stretches, largest first.
    face : Face
    punch_mm : ndarray, shape (k, 2)
        Outline of the punch where it stands now. [mm]
    """

    depth_mm: float
    force_N: float
    rest_mm: Array
    displacement_mm: Array
    cells: Array
    cauchy_MPa: Array
    stretch: Array
    face: Face
    punch_mm: Array

    @property
    def principal_MPa(self) -> Array:
        """Principal values of the Cauchy stress, largest first, shape (n, 3). [MPa]"""
        rr, zz, tt, rz = self.cauchy_MPa.T
        middle, half = 0.5 * (rr + zz), np.hypot(0.5 * (rr - zz), rz)
        return -np.sort(-np.stack([middle + half, middle - half, tt], axis=1), axis=1)

    @property
    def pressure_MPa(self) -> Array:
        """Minus the mean of the principal stresses, shape (n,). [MPa]"""
        return -self.cauchy_MPa[:, :3].mean(axis=1)

    @property
    def von_mises_MPa(self) -> Array:
        """sqrt(3/2 s:s) of the deviator s, shape (n,). [MPa]"""
        one, two, three = self.principal_MPa.T
        return np.sqrt(0.5 * ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2))

    def contact(self) -> dict[str, Any]:
        """Mean, peak and profile of the contact pressure as plain values; lengths in mm, pressures in kPa.

        The mean is the force over the contact seen from above, pi times the square of ``contact_radius_mm``. A sharp
        edge has no finite peak: ``peak_kPa`` is the largest value inside 0.9 of the contact's radius, ``edge_kPa`` the
        largest outside it, which depends on the fillet of the edge.
        """
        face, reach = self.face, self.face.contact_radius_mm
        touched = face.state != FREE
        inner = touched & (face.radius_mm <= 0.9 * reach)
        outer = touched & ~inner
        pressure = 1e3 * face.pressure_MPa
        at = int(np.argmax(np.where(inner, pressure, -np.inf))) if inner.any() else 0
        area = np.pi * reach**2
        return {
            "depth_mm": float(self.depth_mm),
            "force_N": float(self.force_N),
            "contact_radius_mm": reach,
            "mean_kPa": 1e3 * self.force_N / area if area else 0.0,
            "peak_kPa": float(pressure[at]) if inner.any() else 0.0,
            "peak_radius_mm": float(face.radius_mm[at]) if inner.any() else 0.0,
            "edge_kPa": float(pressure[outer].max()) if outer.any() else 0.0,
            "profile": {
                "radius_mm": np.minimum(face.radius_mm[touched], reach).tolist(),
                "pressure_kPa": pressure[touched].tolist(),
                "shear_kPa": (1e3 * face.shear_MPa[touched]).tolist(),
                "state": [STATES[k] for k in face.state[touched]],
            },
        }
