"""A tissue: subjects with their parameters, the bands over them, and what a dummy should aim at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import to_plain
from dummydesign.measurement.motion import RobotPath
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.model.maxwell_law import Parameters, law_named, speed_key
from dummydesign.tissue.model.measured_curves import MeasuredAim
from dummydesign.tissue.model.people_share import share_of_aim, share_parameters
from dummydesign.tissue.model.posterior import DRAWN, drawn_subjects, posterior_subjects
from dummydesign.tissue.model.ranges import ForceRange, force_range
from dummydesign.tissue.model.subject import FITTED, Subject, flatten, subject_parameters

AIMS = ("average", "safe-side")
FOLLOWS = 1.1
"""Factor to which a law meets the peaks it was fitted to: what green allows above the subjects."""


def behind_ranges(subjects: int) -> str:
    """How many subjects a range without a law is of, and how often one more person is outside: 2 / (n + 1)."""
    # of n + 1 people of one population each is as likely to be the lowest, and the highest, whatever its distribution
    if subjects < 2:
        return "it has one subject, who makes no range"
    share = 200.0 / (subjects + 1)
    return f"each range is that of {subjects} subjects; on average {share:.0f} % of people are outside of it"


@dataclass(frozen=True)
class Tissue:
    """Parameters of several subjects at one site of the hand, all fitted with the same law.

    Attributes
    ----------
    name, title, law : str
        Name in the library, words for it, and the form of the law.
    subjects : tuple of Subject
        By rising gamma1 in the built-in tissues.
    sources : tuple of str
        References the numbers rest on.
    notes : tuple of str
        What a user must know before trusting the numbers.
    origin : str
        ``built-in``, ``user`` or ``file``.
    """

    name: str
    title: str
    law: str
    subjects: tuple[Subject, ...]
    sources: tuple[str, ...]
    notes: tuple[str, ...]
    origin: str

    @cached_property
    def parameter_sets(self) -> tuple[Parameters, ...]:
        """Parameters of all subjects."""
        return tuple(subject.parameters for subject in self.subjects)

    @cached_property
    def measured(self) -> bool:
        """Whether its subjects are measured curves, without parameters."""
        return law_named(self.law).measured

    @cached_property
    def notice(self) -> tuple[str, str] | None:
        """Code and words of what every answer must tell about its law; None for nothing."""
        notice = law_named(self.law).notice_of(self.name)
        if notice is not None and self.measured:
            return notice[0], f"{notice[1]}; {behind_ranges(len(self.subjects))}"
        return notice or self._missed()

    def _missed(self) -> tuple[str, str] | None:
        """Code and words on the peak that the law misses most, None where it is near all."""
        known = [(one.pressed[FITTED], one.name) for one in self.subjects if FITTED in one.pressed]
        most, who = max(((max(1.0 / off.low, off.high), name) for off, name in known), default=(1.0, ""))
        if most <= FOLLOWS:
            return None
        return "law_does_not_follow", (
            f"{self.name}: its law misses peaks of {who} by up to {100.0 * (most - 1.0):.0f} %: keep the curves, "
            "'tissues add NAME TRACE... --law none'; the ranges of the law are that far off"
        )

    @property
    def warnings(self) -> list[dict[str, str]]:
        """The notice as a list of warnings."""
        return [] if self.notice is None else [dict(zip(("code", "message"), self.notice))]

    @cached_property
    def elements(self) -> int:
        """Number of elements of the law: 3, 5 or 7; 1 without a relaxing arm."""
        return 1 + 2 * len(self.subjects[0].parameters.gamma_N_per_mm3)

    @cached_property
    def velocities_mm_s(self) -> tuple[float, ...]:
        """Speeds at which all subjects have dampers. [mm/s]"""
        known = [set(subject.parameters.velocities_mm_s) for subject in self.subjects]
        return tuple(sorted(set.intersection(*known)))

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the numbers, such as ``inferred`` or ``fitted``."""
        return tuple(sorted({q.kind for subject in self.subjects for q in flatten(subject.numbers).values()}))

    @cached_property
    def bands(self) -> dict[str, Any]:
        """Band of every parameter: value is the mean over subjects, low and high the extreme subjects."""
        speeds, bands = [speed_key(speed) for speed in self.velocities_mm_s], {}
        for name, entry in self.subjects[0].numbers.items():
            rows = [subject.numbers[name] for subject in self.subjects]
            by_speed = isinstance(entry, dict)
            bands[name] = {key: _band([row[key] for row in rows]) for key in speeds} if by_speed else _band(rows)
        return bands

    def target(self, aim: str = "average") -> Parameters:
        """Parameters a dummy should have.

        ``average`` is the band's mean, ``safe-side`` the largest of each, ``subject:NAME`` one subject's,
        ``people:PERCENT`` the bound of a share of people (:mod:`~dummydesign.tissue.model.people_share`). Of measured
        curves it is the middle, the strict side or the bound of the curves themselves.

        Raises
        ------
        InputError
            For an unknown aim or subject, and for a share of people by fewer than two.
        """
        share = share_of_aim(aim)
        if share is not None:
            return self._share_target(aim, share)
        if aim.lower().startswith("subject:"):
            wanted = aim.split(":", 1)[1].strip().lower()
            for subject in self.subjects:
                if subject.name.lower() == wanted:
                    return subject.parameters
            raise unknown_name(f"subject of {self.name}", wanted, [s.name for s in self.subjects], quantity="subject")
        if aim not in AIMS:
            raise unknown_name("aim", aim, [*AIMS, "subject:NAME", "people:PERCENT"])
        if self.measured:
            return MeasuredAim(self.parameter_sets, aim)  # type: ignore[arg-type]
        return subject_parameters(self.law, self.bands, "value" if aim == "average" else "high")

    def _share_target(self, aim: str, share: float) -> Parameters:
        law = law_named(self.law)
        if len(self.subjects) < 2 or not (law.fitted or law.measured):
            what = "one subject does" if law.fitted or law.measured else "a spring constant and its spread do"
            raise InputError(
                f"aim = '{aim}' needs at least two subjects: {what} not show how people differ; use average or "
                "safe-side, or add people with 'dummydesign tissues add'",
                "not_enough_data",
                "subjects",
                len(self.subjects),
            )
        if self.measured:
            return MeasuredAim(self.parameter_sets, aim)  # type: ignore[arg-type]
        groups = [one.parameter_sets for one in self.posterior(DRAWN) or (self,)]
        return share_parameters(groups, self.parameter_sets, self.velocities_mm_s, share)

    def drawn(self, count: int) -> tuple[Tissue, ...]:
        """Tissues that the data of this one allow; none where one subject, or a standard's spring, says nothing."""
        if len(self.subjects) < 2 or not law_named(self.law).fitted:
            return ()
        return self.posterior(count) or self._with_subjects(drawn_subjects(self.subjects, count))

    def posterior(self, count: int) -> tuple[Tissue, ...]:
        """Return the draws stored with an inferred tissue, by their weights; none where a person was measured."""
        if not law_named(self.law).fitted or self.origin == "file":
            return ()
        if any(subject.numbers["gamma1_N_per_mm3"].kind != "inferred" for subject in self.subjects):
            return ()
        return self._with_subjects(posterior_subjects(self.name, self.subjects, count))

    def _with_subjects(self, groups: Sequence[tuple[Subject, ...]]) -> tuple[Tissue, ...]:
        return tuple(replace(self, subjects=group) for group in groups)

    def steady_depth_range(self, force_N: ArrayLike) -> tuple[NDArray, NDArray]:
        """Depth of the stiffest and of the softest subject over steady force. [mm]"""
        depth = law_named(self.law).steady_depths(self.parameter_sets, force_N)
        return depth.min(axis=0), depth.max(axis=0)

    def force_range(
        self,
        steady_force_N: float,
        velocity_mm_s: float,
        hold_s: float = 10.0,
        deceleration_mm_s2: float = 30_000.0,
        lowpass: Lowpass | None = None,
        path: RobotPath | None = None,
    ) -> ForceRange:
        """Envelope of the subjects' F(t) at one condition; see :func:`dummydesign.tissue.model.ranges.force_range`.

        Parameters
        ----------
        steady_force_N : float
            Force at the end of the hold, the same for every subject. [N]
        velocity_mm_s : float
            Speed of the punch; one at which the subjects have dampers. [mm/s]
        hold_s, deceleration_mm_s2 : float
            Hold after the stop, and braking of the robot. [s, mm/s2]
        lowpass : Lowpass, optional
            Sensor filter to put on the curves; none by default.
        path : RobotPath, optional
            Measured path, shifted to each subject's depth, instead of a ramp with that braking.
        """
        condition = steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2
        return force_range(self.parameter_sets, *condition, lowpass, path)

    def to_dict(self) -> dict[str, Any]:
        """Return the whole tissue with bands, subjects, sources and notes."""
        names = ("name", "title", "origin", "law", "elements", "bands", "subjects", "notes", "sources")
        return to_plain({name: getattr(self, name) for name in names})


def _band(numbers: list[Quantity]) -> Quantity:
    values = [number.value for number in numbers]
    text = f"mean, smallest and largest of {len(values)} subjects; {numbers[0].source}"
    # The weakest kind speaks for the band: one inferred subject makes it inferred.
    order = ("assumed", "inferred", "digitised", "fitted", "measured")
    kind = min({number.kind for number in numbers}, key=order.index)
    return Quantity(sum(values) / len(values), min(values), max(values), kind, text)


def same_shape(subjects: tuple[Subject, ...]) -> None:
    """Refuse subjects that differ in law or elements, or share no speed."""
    first = subjects[0].parameters
    for subject in subjects[1:]:
        if subject.parameters.law != first.law:
            raise InputError(
                f"subject '{subject.name}' has law {subject.parameters.law}, "
                f"'{subjects[0].name}' {first.law}; laws are never mixed",
                "inconsistent",
                "law",
                subject.parameters.law,
                first.law,
            )
        own, wanted = (1 + 2 * len(one.gamma_N_per_mm3) for one in (subject.parameters, first))
        if own != wanted:
            raise InputError(
                f"subject '{subject.name}' has {own} elements, '{subjects[0].name}' {wanted}: "
                "fit all subjects with the same number, such as 'fit --elements 5'",
                "inconsistent",
                "elements",
                own,
                wanted,
            )
    if first.velocities_mm_s:
        share_a_speed({subject.name: subject.parameters.velocities_mm_s for subject in subjects})


def share_a_speed(velocities_mm_s: Mapping[str, Sequence[float]]) -> None:
    """Refuse people of whom one was pressed at none of the first one's speeds."""
    first = next(iter(velocities_mm_s))
    for name, speeds in velocities_mm_s.items():
        if not set(speeds) & set(velocities_mm_s[first]):
            own, others = (", ".join(f"{v:g}" for v in sorted(set(velocities_mm_s[who]))) for who in (name, first))
            raise InputError(
                f"subject '{name}' ({own} mm/s) shares no speed with '{first}' ({others} mm/s): "
                "people pressed at different speeds make no range; press all at one of them",
                "inconsistent",
                "velocity_mm_s",
                list(speeds),
                list(velocities_mm_s[first]),
            )
