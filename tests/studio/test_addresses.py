"""Addresses in links: any name of a folder comes back whole at the server; names of files that were sent."""

import tempfile
from urllib.parse import parse_qs, unquote, urljoin, urlsplit

import pytest

from dummydesign.core.errors import InputError
from dummydesign.studio.file_transfer import check_press, read_sent
from dummydesign.studio.state import address

NAMES = ["plain", "親指 パッド", "50% & more?", "a\"b'<i>#x", "a+b;c=d", "http:x", "caf\udce9"]


@pytest.mark.parametrize("name", NAMES)
def test_a_folder_of_any_name_comes_back_whole_below_the_page_that_links_to_it(name):
    path = f"/files/{name}/report.html"
    for page in ("http://127.0.0.1:8420/abc/", "http://127.0.0.1:8420/abc/design?which=b"):
        led = urlsplit(urljoin(page, address(path, which=name)))
        assert led.netloc == "127.0.0.1:8420" and not set(led.path + led.query) & set(" \"'<>#")
        assert unquote(led.path, errors="surrogateescape") == "/abc" + path
        assert parse_qs(led.query, errors="surrogateescape") == {"which": [name]}


def test_the_first_page_is_the_studio_itself():
    assert urljoin("http://127.0.0.1:8420/abc/design", address("/")) == "http://127.0.0.1:8420/abc/"


def test_a_refusal_names_the_file_that_was_sent_and_no_place_of_this_machine(tmp_path):
    from dummydesign.person.limits import read_limits

    for name, content, read in (("mine.csv", b"1,2\n", None), ("bad.toml", b"name = 'bad'", read_limits)):
        with pytest.raises(InputError) as refused:
            if read is None:
                check_press(name, content)
            else:
                read_sent(name, content, read)
        assert name in str(refused.value) and tempfile.gettempdir() not in str(refused.value)
