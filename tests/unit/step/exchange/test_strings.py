"""Strings of the exchange structure, against the examples of ISO 10303-21 and Python's own codecs."""

import pytest

from stepbot.step.exchange.part21_values import decode_string


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (rb"it''s", "it's"),
        (rb"back\\slash", "back\\slash"),
        (rb"\X2\04210431043E0440\X0\1", "Сбор1"),
        (rb"caf\X\E9", "café"),
        (rb"\S\drger", "ärger"),
        (rb"\PE\\S\!", "Ё"),
        (rb"\X4\0001F600\X0\ ", "\N{GRINNING FACE} "),
        (rb"C:\temp", "C:\\temp"),
        ("Wälzlager".encode(), "Wälzlager"),
        (b"two\n  lines", "twolines"),
    ],
)
def test_escapes(raw: bytes, text: str) -> None:
    """Every directive of the standard is decoded."""
    assert decode_string(raw, "utf-8") == text


def test_bytes_of_another_encoding_are_refused() -> None:
    """Bytes that are not UTF-8 are rejected instead of decoded as other characters."""
    with pytest.raises(UnicodeDecodeError):
        decode_string("Деталь".encode("cp1251"), "utf-8")
