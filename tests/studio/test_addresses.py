"""Addresses in links: any name of a folder comes back whole at the server."""

from urllib.parse import parse_qs, unquote, urljoin, urlsplit

import pytest

from dummydesign.studio.state import address

NAMES = ["plain", "親指 パッド", "50% & more?", 'a"b\'<i>#x', "a+b;c=d", "http:x", "caf\udce9"]


@pytest.mark.parametrize("name", NAMES)
def test_a_folder_of_any_name_comes_back_whole_below_the_page_that_links_to_it(name):
    path = f"/files/{name}/report.html"
    for page in ("http://127.0.0.1:8420/abc/", "http://127.0.0.1:8420/abc/design?which=b"):
        led = urlsplit(urljoin(page, address(path, which=name, none=None)))
        assert led.netloc == "127.0.0.1:8420" and not set(led.path + led.query) & set(" \"'<>#")
        assert unquote(led.path, errors="surrogateescape") == "/abc" + path
        assert parse_qs(led.query, errors="surrogateescape") == {"which": [name]}


def test_the_first_page_is_the_studio_itself():
    assert urljoin("http://127.0.0.1:8420/abc/design", address("/")) == "http://127.0.0.1:8420/abc/"
