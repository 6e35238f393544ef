"""A recording taken apart as the import does it: signs, presses, contacts."""

from typing import Any

from dummydesign.measurement.importing.core.decisions import Notes, Settings
from dummydesign.measurement.importing.press.contact import find_contact
from dummydesign.measurement.importing.press.signs import find_signs
from dummydesign.measurement.importing.press.split import find_presses
from tests.support.machine_presses import Recording


def parts_of(record: Recording, tare: float = 0.0, place: float = 0.0) -> tuple[Any, list[Any], list[Any]]:
    """Signs, spans and contacts of a recording whose zeros are off by ``tare`` [N] and ``place`` [mm]."""
    x, force = record.displacement_mm + place, record.force_N + tare
    signs = find_signs("a.csv", x, force, Settings(), None, Notes())
    load = signs.force * (force - signs.rest_force_N)
    spans = find_presses("a.csv", signs.displacement * x, load, True)
    return signs, spans, [find_contact(record.time_s, signs.displacement * x, load, span) for span in spans]
