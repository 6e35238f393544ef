"""Sources that many places cite are written once, and no number is quoted from memory where a source is named."""

from pathlib import Path

from dummydesign.core.quantity import HAND_STIFFNESS, ISO_TS_15066, NAGOYA_CITATION
from dummydesign.resin import load_resin
from dummydesign.tissue.model.tissue_file import load_tissue
from studies.tissues.infer import SOURCES

ROOT = Path(__file__).parents[2]


def test_the_built_in_tissues_cite_what_they_were_inferred_from():
    for name in ("palm", "thenar", "forefinger"):
        assert tuple(load_tissue(name).sources) == SOURCES
    assert SOURCES[0].startswith(NAGOYA_CITATION) and HAND_STIFFNESS in SOURCES


def test_the_papers_resin_cites_the_paper():
    assert any(text.startswith(NAGOYA_CITATION) for text in load_resin("polyurethane-nagoya").references)


def test_the_page_of_references_names_both_and_what_is_not_known():
    page = " ".join((ROOT / "docs" / "references.md").read_text().split())
    title, venue = NAGOYA_CITATION.split(", IEEE")
    assert title in page and "IEEE" + venue.replace(" (Nagoya University)", "") in page
    assert ISO_TS_15066 in page and "75 N/mm" in page


def test_nothing_of_the_standard_is_quoted_from_memory():
    files = [*(ROOT / "dummydesign").rglob("*.py"), *(ROOT / "materials").rglob("*.toml")]
    lines = [line for file in files for line in file.read_text().splitlines() if "15066" in line]
    assert lines and not [line for line in lines if "memory" in line]
