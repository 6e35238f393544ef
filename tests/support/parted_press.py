"""A recording taken apart as the import does it: signs, presses, contacts."""

from typing import Any

from dummydesign.measurement.importing.contact import find_contact
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.sign_convention import find_presses, find_signs
from tests.support.machine_presses import Recording


def parts_of(record: Recording, tare: float = 0.0, place: float = 0.0) -> tuple[Any, list[Any], list[Any]]:
    """Signs, spans and contacts of a recording whose zeros are off by ``tare`` [N] and ``place`` [mm]."""
    x, force = record.displacement_mm + place, record.force_N + tare
    signs = find_signs(x, force, None, ImportLog("a.csv"))
    load = signs.force * (force - signs.rest_force_N)
    spans = find_presses("a.csv", signs.displacement * x, load, True)
    return signs, spans, [find_contact(record.time_s, signs.displacement * x, load, span) for span in spans]
