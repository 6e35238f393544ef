"""The effects that the loop knows, one class in one file each; a new one is a file and a line here."""

from __future__ import annotations

from dummydesign.core.errors import unknown_name
from dummydesign.loop.effects.history.ageing import Ageing
from dummydesign.loop.effects.history.incomplete_recovery import IncompleteRecovery
from dummydesign.loop.effects.history.softening_with_cycles import SofteningWithCycles
from dummydesign.loop.effects.history.temperature import Temperature
from dummydesign.loop.effects.material.adhesion import Adhesion
from dummydesign.loop.effects.material.compressibility import Compressibility
from dummydesign.loop.effects.material.fast_relaxation_mode import FastRelaxationMode
from dummydesign.loop.effects.material.rate_dependent_viscosity import RateDependentViscosity
from dummydesign.loop.effects.material.slow_relaxation_mode import SlowRelaxationMode
from dummydesign.loop.effects.material.strain_dependent_relaxation import StrainDependentRelaxation
from dummydesign.loop.effects.material.strain_stiffening import StrainStiffening
from dummydesign.loop.effects.material.thickness_error import ThicknessError
from dummydesign.loop.effects.rig.base_slip import BaseSlip
from dummydesign.loop.effects.rig.contact_offset import ContactOffset
from dummydesign.loop.effects.rig.friction_hysteresis import FrictionHysteresis
from dummydesign.loop.effects.rig.machine_compliance import MachineCompliance
from dummydesign.loop.effects.rig.plate_friction import PlateFriction
from dummydesign.loop.effects.rig.punch_tilt import PunchTilt
from dummydesign.loop.effects.sensor.force_bias import ForceBias
from dummydesign.loop.effects.sensor.force_drift import ForceDrift
from dummydesign.loop.effects.sensor.inertia import Inertia
from dummydesign.loop.effects.sensor.sensor_lag import SensorLag
from dummydesign.loop.effects.sensor.time_skew import TimeSkew
from dummydesign.loop.model.effect import Effect

EFFECTS: tuple[Effect, ...] = (
    ContactOffset(), MachineCompliance(), PunchTilt(),
    BaseSlip(), Compressibility(), ThicknessError(), StrainStiffening(),
    StrainDependentRelaxation(), RateDependentViscosity(), SlowRelaxationMode(), FastRelaxationMode(),
    SofteningWithCycles(), IncompleteRecovery(), Temperature(), Ageing(),
    Adhesion(), FrictionHysteresis(), PlateFriction(),
    ForceBias(), ForceDrift(), SensorLag(), TimeSkew(), Inertia(),
)  # fmt: skip
"""All effects, in the order of the stages they act at."""


def effect_named(name: str) -> Effect:
    """Find an effect by its public name."""
    for effect in EFFECTS:
        if effect.name == name:
            return effect
    raise unknown_name("effect", name, [effect.name for effect in EFFECTS])
