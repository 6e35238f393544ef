"""The condensed tangent of a neo-Hookean section, from products of the slopes that J is made of.

In axisymmetry J = (F_rr F_zz - F_rz F_zr) F_tt. With the slopes A = dN/dr, B = dN/dz and T = N/r of the nodes,
U = F_zz A - F_zr B and V = F_rr B - F_rz A, the change of J by radial and axial displacements is

    dJ_r = F_tt U + c T,  dJ_z = F_tt V,  c = F_rr F_zz - F_rz F_zr

and its second derivative holds T'U + U'T (radial twice), T'V + F_tt (A'B - B'A) (radial and axial), nothing axial
twice. So nine rows of each of a few slopes stand for the 45 by 45 moduli of an element: a quarter of the products.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray


class SectionTangent:
    """Tangents of elements of a section whose law adds the same to each of them at every state.

    Parameters
    ----------
    rows : ndarray, shape (elements, 3 points, nodes)
        Slopes d/dr, d/dz and 1/r at each point.
    basis : ndarray, shape (elements, points, pressures)
        Pressures at the points, times weight.
    inverse : ndarray, shape (elements, pressures, pressures)
        Of minus the pressures' compliance.
    same : ndarray, shape (elements, 2 nodes, 2 nodes)
        What the law adds.
    """

    def __init__(self, rows: Array, basis: Array, inverse: Array, same: Array) -> None:
        elements, points, pressures = basis.shape
        nodes = rows.shape[-1]
        by_slope = rows.reshape(elements, points, 3, nodes)
        self._along, self._down, self._hoop = (np.ascontiguousarray(by_slope[:, :, k]) for k in range(3))
        self._across = np.ascontiguousarray(self._along.transpose(0, 2, 1))
        self._basis, self._inverse = basis, inverse
        blocks = same.reshape(elements, nodes, 2, nodes, 2)
        self._same = [np.ascontiguousarray(blocks[:, :, k, :, k]) for k in (0, 1)]
        # Kept, as making such arrays anew takes as long as filling them. Of radial rows: hoop, U, pressures.
        self._left = np.empty((elements, 2 * points + pressures, nodes))
        self._left[:, :points] = self._hoop
        self._left_axial = np.empty((elements, points + pressures, nodes))
        self._right = np.empty((elements, 2 * points + pressures, 2 * nodes))
        self._load = np.empty((elements, 2 * points, pressures))
        self._work = np.empty((2, *self._along.shape))

    def at(self, F: Array, factor: Array, curvature: Array) -> tuple[Array, Array, Array]:
        """Tangent, coupling of displacements and pressures, and the same times the pressures' inverse.

        Parameters
        ----------
        F : ndarray, shape (elements, points, 5)
            Deformation gradients.
        factor, curvature : ndarray, shape (elements, points)
            First and second derivative by J of the energy that depends on it, times weight.

        Returns
        -------
        stiffness : ndarray, shape (elements, 2 nodes, 2 nodes)
        coupling, half : ndarray, shape (elements, 2 nodes, pressures)
        """
        elements, points, nodes = self._along.shape
        rr, rz, zr, zz, tt = (np.ascontiguousarray(F[..., k])[..., None] for k in range(5))
        factor, curvature = factor[..., None], curvature[..., None]
        area, one, two = rr * zz - rz * zr, *self._work
        left, axial, right = self._left, self._left_axial, self._right
        turned, sunk = left[:, points : 2 * points], axial[:, :points]
        np.subtract(np.multiply(zz, self._along, out=one), np.multiply(zr, self._down, out=two), out=turned)
        np.subtract(np.multiply(rr, self._down, out=one), np.multiply(rz, self._along, out=two), out=sunk)
        stretched = curvature * area
        mixed, plain = stretched * tt + factor, curvature * tt * tt
        stretched *= area
        upper, lower = right[:, :points], right[:, points : 2 * points]
        np.add(np.multiply(stretched, self._hoop, out=one), np.multiply(mixed, turned, out=two), out=upper[..., :nodes])
        np.add(np.multiply(mixed, self._hoop, out=one), np.multiply(plain, turned, out=two), out=lower[..., :nodes])
        np.multiply(mixed, sunk, out=upper[..., nodes:])
        np.multiply(plain, sunk, out=lower[..., nodes:])
        coupling, half = self._pressures(area, tt)
        for k, part in enumerate((left[:, 2 * points :], axial[:, points:])):
            part[:] = coupling[:, k::2].transpose(0, 2, 1)
            np.negative(half[:, k::2].transpose(0, 2, 1), out=right[:, 2 * points :, k * nodes : (k + 1) * nodes])
        radial = left.transpose(0, 2, 1) @ right
        skew = self._across @ np.multiply(factor * tt, self._down, out=one)
        both = radial[..., nodes:] + skew
        both -= skew.transpose(0, 2, 1)
        stiffness = np.empty((elements, nodes, 2, nodes, 2))
        np.add(radial[..., :nodes], self._same[0], out=stiffness[:, :, 0, :, 0])
        np.add(axial.transpose(0, 2, 1) @ right[:, points:, nodes:], self._same[1], out=stiffness[:, :, 1, :, 1])
        stiffness[:, :, 0, :, 1], stiffness[:, :, 1, :, 0] = both, both.transpose(0, 2, 1)
        return stiffness.reshape(elements, 2 * nodes, 2 * nodes), coupling, half

    def _pressures(self, area: Array, hoop: Array) -> tuple[Array, Array]:
        """Coupling of displacements and pressures, and the same times the pressures' inverse."""
        elements, points, nodes = self._along.shape
        load = self._load
        np.multiply(area, self._basis, out=load[:, :points])
        np.multiply(hoop, self._basis, out=load[:, points:])
        coupling = np.empty((elements, nodes, 2, self._basis.shape[-1]))
        coupling[:, :, 0] = self._left[:, : 2 * points].transpose(0, 2, 1) @ load
        coupling[:, :, 1] = self._left_axial[:, :points].transpose(0, 2, 1) @ load[:, points:]
        side_by_side = coupling.reshape(elements, 2 * nodes, -1)
        return side_by_side, side_by_side @ self._inverse
