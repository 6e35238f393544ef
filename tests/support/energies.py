"""Energies of the material laws, from the stretches; independent of the stresses and tangents of the package."""

from __future__ import annotations

import numpy as np

from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.material.relaxation import Isochoric, Viscoelastic


def stretches(F):
    """Principal stretches of deformation gradients of five (round) or nine components."""
    size = F.shape[-1]
    block = F.reshape(*F.shape[:-1], 3, 3) if size == 9 else F[..., :4].reshape(*F.shape[:-1], 2, 2)
    found = np.linalg.svd(block, compute_uv=False)
    return found if size == 9 else np.concatenate([found, np.abs(F[..., 4:])], axis=-1)


def energy(law, F):
    """Energy per reference volume; of a viscoelastic law that of the step; its derivative is the stress at its end."""
    if isinstance(law, Viscoelastic):
        total = energy(law.law, F) + law._strength * energy(law.isochoric, F)
        return total if law._history is None else total + 0.5 * _stored(law._history, F)
    length = stretches(F)
    if isinstance(law, Isochoric):
        volume = np.prod(length, axis=-1)
        return energy(law.law, F / np.cbrt(volume)[..., None])
    if isinstance(law, Ogden):
        return sum(m / a * ((length**a).sum(axis=-1) - 3.0) for m, a in zip(law.mu_MPa, law.alpha))
    over = (length**2).sum(axis=-1) - 3.0
    return 0.5 * law.shear_MPa * over + law.c2_MPa * over**2


def _stored(history, F):
    """The history's stress on C = F^T F: H : C."""
    if F.shape[-1] == 9:
        F, H = (part.reshape(*part.shape[:-1], 3, 3) for part in (F, history))
        return np.einsum("...ki,...kj,...ij->...", F, F, H)
    plane, H = (part[..., :4].reshape(*part.shape[:-1], 2, 2) for part in (F, history))
    return np.einsum("...ki,...kj,...ij->...", plane, plane, H) + history[..., 4] * F[..., 4] ** 2
