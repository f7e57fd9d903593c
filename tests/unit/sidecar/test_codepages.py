"""Code pages by name, against Python's own table of them."""

import pytest

from stepbot.sidecar.text import UnknownCodePage, code_page


@pytest.mark.parametrize(
    ("name", "usual"),
    [
        ("cp1251", "cp1251"),
        ("Windows-1251", "cp1251"),
        (" CP1251 ", "cp1251"),
        ("1251", "cp1251"),
        ("GBK", "gbk"),
        ("GB18030", "gb18030"),
        ("Shift_JIS", "shift_jis"),
        ("latin1", "iso8859-1"),
        ("UTF8", "utf-8"),
        ("utf-8-sig", "utf-8"),
    ],
)
def test_names_as_people_write_them(name: str, usual: str) -> None:
    """Case, blanks and aliases are accepted."""
    assert code_page(name) == usual


@pytest.mark.parametrize("name", ["utf-16", "utf-7", "cp037", "base64", "rot13", "unicode_escape", "iso2022_jp"])
def test_what_no_step_file_can_be_in(name: str) -> None:
    """Encodings in which ASCII has other bytes, or that are no text encodings, are rejected by name."""
    with pytest.raises(UnknownCodePage, match=f"code page '{name}' is not ASCII-compatible"):
        code_page(name)


@pytest.mark.parametrize(
    ("name", "near"), [("cp1521", "cp1251"), ("bgk", "gbk"), ("klingon", ""), ("", ""), ("\0", "")]
)
def test_unknown_names(name: str, near: str) -> None:
    """An unknown name is reported with suggestions and examples."""
    with pytest.raises(UnknownCodePage, match="unknown code page") as raised:
        code_page(name)
    assert near in raised.value.hints[0]
    assert "cp1251" in raised.value.hints[-1]
