"""Sections of a suggestion's report: inside of the pressed pad."""

from __future__ import annotations

import numpy as np

from dummydesign.core.tables import Table
from dummydesign.design.plot_data import ABOVE_MM, PressedPad, PressPictures
from dummydesign.design.suggestion import Suggestion
from dummydesign.report.front_page import full_sentence
from dummydesign.report.page import Section
from dummydesign.report.plot import Plot, Series

TITLE = "Inside the pressed pad"
STRIP = 0.78
"""Where the strips beside the pad that show the tissue's depth begin, over the picture's half width."""


def pressed_section(answer: Suggestion, pictures: PressPictures) -> Section:
    """Cross-sections of the recommended pad, contact pressure over the radius, and how a slab's compares."""
    if not pictures.pads:
        return Section(TITLE, f"Pictures of the inside are {pictures.left_out}.")
    corrected = "" if answer.calibration is None else ", without what the calibration corrects"
    off = 100.0 * max(abs(one.static_N / one.force_N - 1.0) for one in (*pictures.pads, *pictures.slab))
    text = (
        "Deformed cross-section through the middle, to scale, at the depths of the steady forces: von Mises stress in "
        "kPa, darker is less; where the colours end, as at the punch's edge, it goes on rising. Beside the pad, the "
        "depths of the subjects at the same force. Finite elements under the circle of the punch's area"
        f"{corrected}; their force at these depths is within {max(1.0, np.ceil(off)):.0f} % of the design's."
    )
    plots = [_section(answer, one, pictures.ceiling_kPa) for one in pictures.pads]
    plots.append(_pressure(pictures))
    words = "\n\n".join(part for part in (text, _compared(pictures), full_sentence(pictures.left_out)) if part)
    return Section(TITLE, words, plots, _table(pictures))


def _section(answer: Suggestion, pad: PressedPad, ceiling_kPa: float) -> Plot:
    """One cross-section, with the punch and what the subjects' depth is."""
    half = float(-1.5 * pad.radius_mm[0] + 0.5 * pad.radius_mm[1])
    rest = float(pad.height_mm.max() + 0.5 * (pad.height_mm[1] - pad.height_mm[0]))
    top = rest + ABOVE_MM
    stress = np.clip(pad.stress_kPa, 0.0, ceiling_kPa)
    out, up = pad.punch_mm.T
    across, foot = np.r_[-out[::-1], out], np.r_[up[::-1], up]
    r, z = pad.face_mm.T
    stiff, soft = (float(one[0]) for one in answer.targets.depth_range_mm(np.array([pad.force_N])))
    aim = float(answer.targets.aim_depth_mm(np.array([pad.force_N]))[0])
    thick = answer.best.thickness_mm
    ends = [np.array([STRIP * half, half]), np.array([-half, -STRIP * half])]
    name = f"subjects at {pad.force_N:g} N"
    cells = Series.map("von Mises stress in kPa", pad.radius_mm, pad.height_mm, stress, (0.0, ceiling_kPa), smooth=True)
    series: list[Series] = [cells]
    series += [Series.band(name, side, np.full(2, thick - soft), np.full(2, thick - stiff)) for side in ends]
    series += [Series.line(f"aim: {answer.request.aim}", side, np.full(2, thick - aim), "aim") for side in ends]
    series.append(Series.band("punch", across, foot, np.full_like(foot, max(top, float(foot.max()))), style="extra"))
    series.append(Series.line("tested face", np.r_[-r[::-1], r], np.r_[z[::-1], z]))
    contact = pad.contact
    alt = (
        f"Cross-section at {pad.force_N:g} N: the punch is {pad.depth_mm:.2f} mm deep, the subjects {stiff:.2f} to "
        f"{soft:.2f} mm; contact radius {contact['contact_radius_mm']:.1f} mm."
    )
    title = f"{pad.force_N:g} N: {pad.depth_mm:.2f} mm deep"
    return Plot(
        f"pressed-{pad.force_N:g}N",
        title,
        alt,
        "from the axis [mm]",
        "height [mm]",
        "radius_mm",
        "height_mm",
        series,
        x_range=(-half, half),
        y_range=(0.0, top),
        to_scale=True,
    )


def _pressure(pictures: PressPictures) -> Plot:
    """Contact pressure over the radius at the highest force, both pads."""
    series, words = [], []
    deepest = pictures.pads[-1]
    for pad, style in ((deepest, "main"), *((one, "alt1") for one in pictures.slab[-1:])):
        profile = pad.contact["profile"]
        series.append(Series.line(pad.title, profile["radius_mm"], profile["pressure_kPa"], style))
        words.append(
            f"{pad.title} {pad.contact['mean_kPa']:.3g} kPa on average, {pad.contact['peak_kPa']:.3g} at most "
            f"{_peak_words(pad)}"
        )
    high = 1.3 * max(max(one.contact["peak_kPa"], one.contact["mean_kPa"]) for one in (deepest, *pictures.slab[-1:]))
    note = "the last tenth of the contact, at the punch's edge, may leave the picture"
    return Plot(
        "contact-pressure",
        f"Contact pressure at {deepest.force_N:g} N",
        f"{'; '.join(words)}.",
        "from the axis [mm]",
        "contact pressure [kPa]",
        "radius_mm",
        "pressure_kPa",
        tuple(series),
        y_range=(0.0, high),
        note=note,
    )


def _peak_words(pad: PressedPad) -> str:
    """Where inside the contact the pressure is largest, in words."""
    at, reach = pad.contact["peak_radius_mm"], pad.contact["contact_radius_mm"]
    return "at the centre" if at < 0.1 * reach else f"{at:.1f} mm from the middle"


def _edge(pad: PressedPad) -> str:
    """What the pressure does at the end of the contact."""
    if pad.contact["edge_kPa"] > pad.contact["peak_kPa"]:
        return "and rises without bound at the punch's sharp edge"
    return "and falls towards the end of the contact"


def _compared(pictures: PressPictures) -> str:
    """Peak of the contact pressure and its place, slab and shaped pad, at the highest force."""
    pad = pictures.pads[-1]
    own = (
        f"At {pad.force_N:g} N the pressure on the {pad.title} pad averages {pad.contact['mean_kPa']:.3g} kPa; away "
        f"from the punch's edge it is largest {_peak_words(pad)}, {pad.contact['peak_kPa']:.3g} kPa, {_edge(pad)}"
    )
    if not pictures.slab:
        return f"{own}."
    flat = pictures.slab[-1]
    ratio = pad.contact["peak_kPa"] / flat.contact["peak_kPa"]
    return (
        f"{own}. On the best slab it averages {flat.contact['mean_kPa']:.3g} kPa at {flat.force_N:g} N, is largest "
        f"{_peak_words(flat)}, {flat.contact['peak_kPa']:.3g} kPa, {_edge(flat)}. The peak away from the edge is "
        f"{ratio:.2g} times the slab's."
    )


def _table(pictures: PressPictures) -> Table:
    pads = (*pictures.pads, *pictures.slab)
    return Table.of(
        ({**pad.contact, **vars(pad)} for pad in pads),
        {
            "pad": "title",
            "steady N": "force_N:g",
            "depth mm": "depth_mm:.2f",
            "contact radius mm": "contact_radius_mm:.1f",
            "mean kPa": "mean_kPa:.3g",
            "largest away from the edge kPa": "peak_kPa:.3g",
            "at radius mm": "peak_radius_mm:.1f",
            "at the edge": lambda row: "rises" if row["edge_kPa"] > row["peak_kPa"] else "falls",
        },
    )
