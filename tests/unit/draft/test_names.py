"""Roles suggested by component names."""

import pytest

from stepbot.draft.parts.names import Role, portable, roles


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("DIN 912 M3x12", Role.FASTENER),
        ("ISO_4762-M4", Role.FASTENER),
        ("GB/T 70.1 M3", Role.FASTENER),
        ("91290A115", Role.FASTENER),
        ("M3x8 hex", Role.FASTENER),
        ("Zylinderschraube", Role.FASTENER),
        ("Luftschraube", None),
        ("自攻M2x8-1", Role.FASTENER),
        ("Schraube M3", Role.FASTENER),
        ("винт", Role.FASTENER),
        ("内六角螺钉M3", Role.FASTENER),
        ("mr126zz:3", Role.BEARING),
        ("MTA05-13ZZ DBS", Role.BEARING),
        ("SFL688ZZ", Role.BEARING),
        ("SKF 61805-2RS1", Role.BEARING),
        ("底板", Role.BASE),
        ("åº\x95æ\x9d¿", Role.BASE),
        ("小齿轮", Role.GEAR),
        ("前轮", Role.WHEEL),
        ("Gehäuse", None),
        ("pizza", None),
        ("Kugellager_6001", Role.BEARING),
        ("Rillenkugellager 6003", Role.BEARING),
        ("Brg 608", Role.BEARING),
        ("SFU1204 screw 560", Role.SLIDE),
        ("Lead screw nut TR8x8", Role.SLIDE),
        ("M8 threaded rod", Role.FASTENER),
        ("caster fork", None),
        ("Caster wheel", Role.WHEEL),
        ("軸受け", Role.BEARING),
        ("DIN 625", Role.BEARING),
        ("STS3215_03a:1", Role.MOTOR),
        ("XL-430_new:1", Role.MOTOR),
        ("MG90S", Role.MOTOR),
        ("25GA-370-1", Role.MOTOR),
        ("37GB520", Role.MOTOR),
        ("MG-996R", Role.MOTOR),
        ("ST3215", Role.MOTOR),
        ("AX-12A", Role.MOTOR),
        ("MGN9", Role.SLIDE),
        ("舵机", Role.MOTOR),
        ("Motor_holder_SO101_Wrist:1", None),
        ("Motorhalter", None),
        ("DC15_A01_HORN_DUMMY", Role.HORN),
        ("DC15_A01_CASE_M_DUMMY", Role.MOTOR),
        ("left wheel", Role.WHEEL),
        ("wheelbase", None),
        ("Spindle", None),
        ("base_link", Role.BASE),
    ],
)
def test_first_role_of_a_name(name: str, role: Role | None) -> None:
    """A standard, a catalogue number or a whole word gives the role; part of a word or a motor's bracket does not."""
    assert next(iter(roles(name)), None) == role


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Upper arm v3:1", "Upper_arm"),
        ("Gehäuse groß", "Gehause_gross"),
        ("łożysko", "lozysko"),
        ("タイヤφ44用7.5mm幅_RT-T75-44-R", "wheel"),
        ("底座", "base"),
        ("колесо", "wheel"),
        ("Пример", ""),
        ("????", ""),
        ("Pe\x87a", "Pe_a"),
        ("103.1", "103_1"),
    ],
)
def test_names_of_links_are_portable(name: str, expected: str) -> None:
    """Accents are removed, another script gives the role that it names, and lost bytes give nothing."""
    assert portable(name) == expected
