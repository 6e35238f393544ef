"""Addresses of the studio's pages and files, as links of its pages write them."""

from __future__ import annotations

from urllib.parse import quote, urlencode


def address(path: str, **query: object) -> str:
    """Return the address of a page or file for a link of a page, quoted.

    The address is relative. The studio lies under a path that changes at each start, and every page is one step below.

    Parameters
    ----------
    path : str
        From the studio's root on, not quoted: ``/design``, ``/files/designs/a/report.html``.
    query : object
        Values by name; None is left out.
    """
    filled = {name: value for name, value in query.items() if value is not None}
    given = urlencode(filled, quote_via=quote, errors="surrogateescape")
    return "./" + quote(path.lstrip("/"), safe="/", errors="surrogateescape") + (f"?{given}" if given else "")
