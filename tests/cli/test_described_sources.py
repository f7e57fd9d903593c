"""Commands that take a URDF in place of a sidecar."""

from pathlib import Path

import pytest

from .conftest import Stepbot

CART = """<robot name="cart"><link name="chassis"><inertial>
  <mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
</inertial></link></robot>"""


@pytest.fixture
def cart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file, in the current folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cart.urdf").write_text(CART, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_base_and_packages_are_options_of_all_conversions(cart: Path, stepbot: Stepbot) -> None:
    """`batch`, `uptodate` and `check` take the base that `convert` does; `uptodate` finds files of another base."""
    batch = stepbot("batch", "cart.urdf", "-o", "out", "-f", "mjcf", "--no-verify", "--base", "floating")
    assert batch.code == 0, batch.err
    assert "freejoint" in (cart / "out/cart/cart.xml").read_text(encoding="utf-8")
    command = ("uptodate", "cart.urdf", "-o", "out/cart", "-f", "mjcf")
    assert stepbot(*command, "--base", "floating").code == 0
    other = stepbot(*command)
    assert other.code == 1
    assert "SB007" in other.out
    assert "SB874:base" in stepbot("check", "cart.urdf").out
    assert "SB874:base" not in stepbot("check", "cart.urdf", "--base", "floating").out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "format_"),
    [("r.usda", '#usda 1.0\ndef Xform "r" {}\n', "usd"), ("r.proto", "#VRML_SIM R2023b utf8\n", "webots")],
)
def test_formats_that_are_written_alone(name: str, text: str, format_: str, cart: Path, stepbot: Stepbot) -> None:
    """OpenUSD and PROTOs are not taken for sidecars: the error says which formats are converted."""
    (cart / name).write_text(text, encoding="utf-8")
    run = stepbot("convert", name, "--no-verify")
    assert run.code == 1
    assert f"{name}: error[SB823]: only urdf, sdf, mjcf can be converted and shown, not {format_}" in run.err


@pytest.mark.parametrize(
    "command",
    [
        ("convert", "cart.urdf", "--step", "cart.step"),
        ("batch", "cart.urdf", "-o", "out", "--scheduler", "tcp://127.0.0.1:1"),
        ("check", "cart.urdf", "--step", "cart.step"),
        ("check", "cart.urdf", "--step", "--strict"),
        ("check", "cart.urdf", "--fix", "--strict"),
    ],
)
def test_options_of_sidecars_alone_are_usage_errors(command: tuple[str, ...], cart: Path, stepbot: Stepbot) -> None:
    """An option that a description has no use for is rejected, not ignored."""
    run = stepbot(*command)
    assert run.code == 2
    assert f"{command[-2]} needs a sidecar: cart.urdf is a robot description" in run.err
    assert not (cart / "out").exists()


def test_lock_of_a_description_is_a_usage_error(cart: Path, stepbot: Stepbot) -> None:
    """A lock file records the components of a STEP file; the error says so, and no lock is written."""
    run = stepbot("lock", "cart.urdf")
    assert run.code == 2
    assert "lock needs a sidecar: cart.urdf is a robot description" in run.err
    assert [path.name for path in cart.iterdir()] == ["cart.urdf"]
