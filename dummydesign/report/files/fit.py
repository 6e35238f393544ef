"""Files of a fit: the tissue file of one subject, the residuals as table and picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_bytes, write_text
from dummydesign.report.fit import write_fit_report
from dummydesign.tissue.fitting.fit import Fit
from dummydesign.tissue.fitting.residuals import residual_plot, residual_table
from dummydesign.tissue.fitting.subject import subject_from_fit
from dummydesign.tissue.model.tissue import Tissue
from dummydesign.tissue.model.tissue_file import tissue_toml


def write_fit(fit: Fit, out: str, sources: Sequence[str] = ()) -> dict[str, str]:
    """Write ``out`` (a tissue TOML of one subject) and beside it the residuals as CSV and PNG, and the report.

    Parameters
    ----------
    fit : Fit
    out : str
        Path of the tissue file; the report is ``STEM-report.html`` with its CSV files.
    sources : sequence of str
        References, for the report.

    Raises
    ------
    InputError
        When ``out`` does not end in .toml or the files cannot be written.
    """
    path = Path(out)
    if path.suffix.lower() != ".toml":
        raise InputError(f"--out '{out}' must end in .toml: a tissue file is written there")
    subject = subject_from_fit(path.stem, fit)
    notes = tuple(warning["message"] for warning in fit.result["warnings"])
    tissue = Tissue(path.stem, f"fit of {path.stem}", fit.law, (subject,), (), notes, "file")
    files = {
        "tissue": path,
        "residuals": path.with_name(f"{path.stem}_residuals.csv"),
        "residual_plot": path.with_name(f"{path.stem}_residuals.png"),
    }
    write_text(files["tissue"], tissue_toml(tissue))
    write_text(files["residuals"], residual_table(fit.problems))
    write_bytes(files["residual_plot"], residual_plot(fit.problems, f"{path.stem}, law {fit.law}, {fit.mode}"))
    report = write_fit_report(path.parent, path.stem, fit, sources)
    return {role: str(place) for role, place in files.items()} | report
