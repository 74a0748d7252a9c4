"""Only here: commands that end with another status, lose rows, or say what is wrong in more than a line."""

# ruff: noqa: E501 (a row of the table is a line)

import csv
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import demheat
from demheat import gallery
from demheat.declared import all_methods
from demheat.io import scenes
from demheat.terminal.commands import answers, compare, main
from demheat.terminal.commands.knobs import asked

ROOT = Path(__file__).parents[4]
# The simple cubic array, contrast 5, a sphere of a third of the edge.
EXACT = 42.6403350747
CHEAP = "exact,maxwell,rayleigh"


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    scenes.write(gallery.sphere_in_cube(5.0, radius=0.1 / 3, temperatures=(25.0, 35.0)), path)
    return path


@pytest.fixture
def laminate(tmp_path):
    """Whose exact field is evaluated in no time."""
    path = tmp_path / "laminate.toml"
    scenes.write(gallery.laminate(), path)
    return path


def run(capsys, *words):
    """Exit status, output and what is said of errors."""
    status = main([str(word) for word in words])
    told = capsys.readouterr()
    return status, told.out, told.err


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return {row["method"]: row for row in csv.DictReader(file)}


def test_solve_prints_the_conductivity(capsys, scene):
    status, out, err = run(capsys, "solve", scene, "--method", "exact", "--method", "maxwell")
    assert (status, err) == (0, "")
    assert "box of 100 x 100 x 100 mm, 1 sphere, 33 to 165 W/(m K), walls y-, y+" in out
    numbers = [float(number) for number in re.findall(r"conductivity +([\d.]+)", out)]
    # Six decimals and more are printed; Maxwell's formula is 7e-4 off at a seventh of the volume.
    assert abs(numbers[0] - EXACT) < 1e-6 and 0 < abs(numbers[1] / EXACT - 1) < 1e-3


def test_solve_stores_fields(capsys, laminate, tmp_path):
    status, out, _ = run(capsys, "solve", laminate, "--method", "exact", "--out", tmp_path / "out")
    assert status == 0 and str(tmp_path / "out" / "exact.npz") in out
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["exact.npz", "exact.png"]


def test_solve_writes_one_field(capsys, laminate, tmp_path):
    status, out, _ = run(capsys, "solve", laminate, "--method", "exact", "--write", tmp_path / "field.vti")
    assert status == 0 and (tmp_path / "field.vti").stat().st_size > 1000
    for name in ("field.vtu", "field.xdmf", "field.vtp"):
        status, out, _ = run(capsys, "solve", laminate, "--method", "exact", "--write", tmp_path / name)
        assert status == 0 and name in out and (tmp_path / name).stat().st_size > 1000
    status, _, err = run(capsys, "solve", laminate, "--methods", "exact,maxwell", "--write", tmp_path / "field.vti")
    assert status == 2 and "of one method, and 2 are asked for" in err


def test_a_slip_in_one_method_does_not_cost_the_others(capsys, laminate, tmp_path, monkeypatch):
    real = answers.load

    def load(name):
        if name == "bounds":
            raise KeyError("a slip\nof two lines")
        return real(name)

    monkeypatch.setattr(answers, "load", load)
    status, out, _ = run(capsys, "compare", laminate, "--methods", "maxwell,exact", "--out", tmp_path / "out")
    stored = rows(tmp_path / "out" / "laminate.csv")
    assert status == 1 and stored["exact"]["status"] == "ok"
    assert stored["maxwell"]["status"] == "failed" and stored["maxwell"]["note"].startswith("KeyError: ")
    assert "maxwell failed: KeyError" in out


def test_warnings_are_notes(capsys, laminate, monkeypatch):
    def warned(scene, method, knobs, interval):
        warnings.warn("thin\nlayers", stacklevel=1)
        return answers.Answer("ok", 1.0, cost={"wall_s": 1.0, "cpu_s": 1.0})

    monkeypatch.setattr(answers, "_run", warned)
    status, _, err = run(capsys, "solve", laminate, "--method", "exact")
    assert status == 0 and err == "demheat: exact: warning: thin layers\n"


def test_the_status_is_that_of_the_worst(capsys, scene, laminate):
    status, _, err = run(capsys, "solve", laminate, "--methods", "exact,maxwell")
    assert status == 1 and err.count("\n") == 1 and "maxwell: a layer, Scene.inclusions[0]" in err
    status, out, err = run(capsys, "solve", scene, "--methods", "exact", "--knob", "points_per_axis=0")
    assert status == 2 and "conductivity" not in out and "points_per_axis = 0: must be" in err


WRONG = [
    (["sovle", "SCENE"], "invalid choice: 'sovle'.*did you mean 'solve'"),
    (["solve"], "the following arguments are required: SCENE.toml"),
    ([], "the following arguments are required: COMMAND"),
    (["solve", "scene.tmol"], "scene.tmol: cannot be read: there is no such file; did you mean 'scene.toml'"),
    (["solve", "SCENE", "--mehtod", "exact"], "unrecognized arguments: --mehtod exact; did you mean '--method'"),
    (["solve", "SCENE", "--mehtod=exact"], "did you mean '--method'"),
    (["solve", "SCENE", "--method", "exat"], "--method exat: no such method; did you mean 'exact'"),
    (["solve", "SCENE", "--method", "maxwel"], "did you mean 'maxwell'"),
    (["solve", "SCENE", "--method", "exact", "--knob", "points=4"], "--knob points=4: no knob of exact; did you mean 'points_per_axis'"),
    (["solve", "SCENE", "--method", "maxwell", "--knob", "voxels=4"], "--knob voxels=4: no knob of maxwell; must be one of formula"),
    (["scene.toml"], "a command comes first, as `demheat solve scene.toml`"),
    (["view", "SCENE", "--knob", "voxels=4"], "--knob voxels=4: no method is named; must be with --method"),
    (["solve", "SCENE", "--method", "exact", "--knob", "voxels"], "--knob voxels: must be like voxels=64"),
    (["solve", "SCENE", "--method", "exact", "--knob", "fft.voxels=4"], "no method 'fft' is asked for"),
    (["solve", "SCENE", "--method", "rayleigh", "--knob", "formula=maxwell"], "method 'rayleigh' is what has formula = 'rayleigh'; must be left out"),
    (["recommend", "SCENE", "--accuracy", "2"], "--accuracy 2: must be a number from 1e-9 to below 1"),
    (["recommend", "SCENE", "--accuracy", "much"], "--accuracy much: must be a number from 1e-9 to below 1, as 0.01, or per cent, as 1%"),
    (["effective", "SCENE", "--accuracy", "100%"], "--accuracy 100%: must be a number from 1e-9 to below 1"),
    (["effective", "SCENE", "--accuracy", "0,5%"], "or per cent, as 1%; decimals have a point"),
    (["compare", "SCENE", "--seconds", "1min"], "--seconds 1min: must be a number of seconds > 0, as 60"),
    (["solve", "SCENE", "--seconds", "inf"], "--seconds inf: must be a number of seconds > 0, as 60"),
    (["compare", "SCENE", "--budget", "5"], "did you mean '--seconds'.*demheat compare --help tells more"),
    (["compare", "SCENE", "--accuracy", "1%"], "--accuracy 1%; only effective, recommend, judge has it"),
    (["report", "SCENE", "--methods", "fft,nope"], "--methods fft,nope: no such method, 'nope'; must be one of dem, .*multipole"),
    (["effective", "SCENE", "--method", "maxwell"], "--method maxwell: no such method; must be one of exact, multipole, fem"),
    (["effective", "SCENE", "--method", "fft-em"], "--method fft-em: no such method; did you mean"),
    (["compare", "SCENE", "--method", "exact", "--out", "SCENE"], "--out .*scene.toml: must be a folder, and .* is a file"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "told"), WRONG, ids=[" ".join(words) for words, _ in WRONG])
def test_what_is_wrong_is_one_line(capsys, monkeypatch, scene, words, told):
    monkeypatch.chdir(scene.parent)
    status, _, err = run(capsys, *(str(scene) if word == "SCENE" else word for word in words))
    assert status == 2
    assert re.match(rf"demheat: .*(?:{told})", err) and err.count("\n") == 1, err


def test_a_wrong_knob_of_a_file_has_its_line(capsys, scene):
    for more, told in (
        ("points = 3", "solve.exact.points: no knob of exact; did you mean 'points_per_axis'"),
        ('points_per_axis = "3"', r"exact: points_per_axis = '3': must be"),
    ):
        path = scene.with_name("knobs.toml")
        path.write_text(scene.read_text() + "[solve.exact]\n" + more + "\n")
        lines = path.read_text().count("\n")
        status, _, err = run(capsys, "solve", path)
        assert status == 2 and told in err and err.count("\n") == 1
        assert f":{lines}: " in err or "must be" in err


def test_a_knob_goes_to_the_methods_that_have_it(capsys, scene, tmp_path):
    knobs = ["--knob", "points_per_axis=2", "--knob", "maxwell.formula=maxwell"]
    assert run(capsys, "compare", scene, "--methods", CHEAP, *knobs, "--out", tmp_path / "out")[0] == 0
    stored = rows(tmp_path / "out" / "scene.csv")
    assert [row["knobs"] for row in stored.values()] == ["points_per_axis=2", "formula=maxwell", ""]


def test_what_values_of_knobs_mean(scene):
    file = scenes.read_file(scene)
    words = [
        "fem.size=20 mm",
        "fem.curved=false",
        "fft.tolerance=1e-5",
        "fft.threads=none",
        "fft.voxels=32",
        "fft.rule=plain",
    ]
    with pytest.raises(ValueError, match="method 'fem' is what has curved = True; must be left out"):
        asked(file, ["fem", "fft"], words, default=())
    with pytest.raises(ValueError, match="--knob fem.size=2 kg: unit 'kg' does not fit"):
        asked(file, ["fem"], ["fem.size=2 kg"], default=())
    found = asked(file, ["fem", "fft"], [words[0], *words[2:5]], default=())
    assert [each.knobs for each in found] == [{"size": 0.02}, {"tolerance": 1e-5, "threads": None, "voxels": 32}]
    (dem,) = asked(file, None, ["particles=5e4", "allow_few=True"], default=("dem",))
    assert dem.knobs == {"particles": 50000, "allow_few": True} and type(dem.knobs["particles"]) is int


def test_an_accuracy_may_be_per_cent(capsys, laminate):
    """On the command line and in a file, as the decimal that is written there."""
    for words in (["--accuracy", "0.7%"], ["--accuracy", "0.7 %"]):
        status, out, _ = run(capsys, "recommend", laminate, *words)
        assert status == 0 and "to an accuracy of 0.007\n" in out
    laminate.write_text('accuracy = "0.7 %"\n' + laminate.read_text(encoding="utf-8"), encoding="utf-8")
    assert scenes.read_file(laminate).accuracy == 0.007
    status, out, _ = run(capsys, "effective", laminate, "--methods", "exact;fft")
    # One accuracy, the one that was found.
    assert status == 0 and re.search(r"\nby exact, within \S+ % \(", out) and "accuracy" not in out.partition("\n")[2]


def test_version_and_help(capsys):
    for words, told in (
        (["--version"], f"demheat {demheat.__version__}\n"),
        (["solve", "--help"], "--knob NAME=VALUE"),
    ):
        with pytest.raises(SystemExit) as caught:
            main(words)
        assert caught.value.code == 0 and told in capsys.readouterr().out


def test_compare_puts_all_in_one_table(capsys, scene, tmp_path):
    out = tmp_path / "out"
    status, told, _ = run(capsys, "compare", scene, "--methods", CHEAP + ",fem-bricks", "--out", out)
    assert status == 0
    assert sorted(path.name for path in out.iterdir()) == ["scene.csv", "scene.png", "scene.slice.npz"]
    stored = rows(out / "scene.csv")
    assert list(stored) == ["exact", "maxwell", "rayleigh", "fem-bricks"]
    assert abs(float(stored["exact"]["conductivity"]) - EXACT) < 1e-9
    assert float(stored["exact"]["lower"]) < EXACT < float(stored["exact"]["upper"])
    assert (stored["maxwell"]["status"], stored["maxwell"]["lower"]) == ("ok", "")
    assert stored["fem-bricks"]["status"] == "refused"
    assert "fem-bricks refused: fem-bricks solves in time" in told
    low, high = (float(part) for part in re.search(r"Reuss, Voigt +([\d.]+) +([\d.]+)", told).groups())
    share = 4 / 3 * 3.141592653589793 / 27
    assert abs(low * ((1 - share) / 33 + share / 165) - 1) < 1e-5 and abs(high / (33 + share * 132) - 1) < 1e-5
    low, high = (float(part) for part in re.search(r"Hashin-Shtrikman +([\d.]+) +([\d.]+)", told).groups())
    assert low < EXACT * 1.001 and EXACT < high


def test_rows_are_stored_one_by_one_and_used_again(capsys, scene, tmp_path, monkeypatch):
    """What a kill at any moment leaves is a table of whole rows; the same command goes on behind them."""
    calls, real = [], compare.answered
    # Pictures are others' matter.
    monkeypatch.setattr(compare, "picture", lambda *_: "none")
    monkeypatch.setattr(compare, "_keep_slice", lambda *_, **__: None)

    def answered(of, each, **knobs):
        calls.append(each.method.name)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return real(of, each, **knobs)

    monkeypatch.setattr(compare, "answered", answered)
    command = ("compare", scene, "--methods", CHEAP, "--out", tmp_path / "out")
    status, _, err = run(capsys, *command)
    assert status == 130 and "interrupted" in err
    before = rows(tmp_path / "out" / "scene.csv")
    assert list(before) == ["exact"]
    assert run(capsys, *command)[0] == 0
    assert calls == ["exact", "maxwell", "maxwell", "rayleigh"]
    after = rows(tmp_path / "out" / "scene.csv")
    assert list(after) == CHEAP.split(",") and after["exact"] == before["exact"]
    # Nothing to do; then other knobs, and all by force.
    run(capsys, *command)
    assert len(calls) == 4
    run(capsys, *command, "--knob", "points_per_axis=3")
    assert calls[4:] == ["exact"]
    run(capsys, *command, "--force")
    assert calls[5:] == CHEAP.split(",")
    # Rows of other methods and knobs stay, until the scene is another.
    run(capsys, "compare", scene, "--methods", "bruggeman", "--out", tmp_path / "out")
    assert list(rows(tmp_path / "out" / "scene.csv")) == [*CHEAP.split(","), "bruggeman"]
    assert run(capsys, *command)[0] == 0 and calls[8:] == ["bruggeman"]


def test_another_scene_is_another_row(capsys, scene, tmp_path):
    command = ("compare", scene, "--methods", "maxwell", "--out", tmp_path / "out")
    run(capsys, *command)
    before = rows(tmp_path / "out" / "scene.csv")
    scenes.write(gallery.sphere_in_cube(6.0), scene)
    run(capsys, *command)
    after = rows(tmp_path / "out" / "scene.csv")
    assert (tmp_path / "out" / "scene.csv").read_text(encoding="utf-8").count("\n") == 2
    assert list(after) == ["maxwell"] and after["maxwell"]["conductivity"] != before["maxwell"]["conductivity"]


def test_a_spoilt_table_is_not_overwritten(capsys, scene, tmp_path):
    path = tmp_path / "out" / "scene.csv"
    path.parent.mkdir()
    for text in ("method,conductivity\nexact,1\n", "not a table", '"', "\xff"):
        path.write_text(text, encoding="latin-1")
        status, _, err = run(capsys, "compare", scene, "--methods", "maxwell", "--out", path.parent)
        assert status == 2 and "must hold rows of a comparison" in err
        assert path.read_text(encoding="latin-1") == text


def test_recommend_and_effective(capsys, scene):
    status, out, _ = run(capsys, "recommend", scene, "--accuracy", "1e-4")
    assert status == 0 and "exact, to an accuracy of 0.0001" in out and "fem: about" in out
    status, out, _ = run(capsys, "effective", scene, "--method", "exact")
    assert status == 0
    numbers = [float(number) for number in re.findall(r"([\d.]+) \+- ", out)]
    # By symmetry the same along all axes, and nothing between them; printed with six decimals or more.
    assert [round(abs(k - (EXACT if n % 4 == 0 else 0.0)), 6) for n, k in enumerate(numbers)] == [0.0] * 9


def test_recommend_says_when_nothing_gets_there(capsys, scene, monkeypatch):
    monkeypatch.setattr(sys.modules["demheat.cheapest.effective"], "free_memory", lambda: 1.0)
    status, out, _ = run(capsys, "recommend", scene)
    # The closed form needs none.
    assert status == 0
    scenes.write(gallery.random_dispersion(3, fraction=0.1, seed=1, periodic=False), scene)
    status, out, _ = run(capsys, "recommend", scene)
    assert status == 1 and "no method for sure" in out


def test_view_draws_scene_and_field(capsys, laminate, tmp_path):
    status, out, _ = run(capsys, "view", laminate, "--method", "exact", "--out", tmp_path / "out")
    assert status == 0
    for name in ("laminate-scene.png", "laminate-exact.png"):
        assert (tmp_path / "out" / name).read_bytes().startswith(b"\x89PNG") and name in out
    assert run(capsys, "view", laminate, "--method", "fem-bricks", "--out", tmp_path / "out")[0] == 1


def test_compare_takes_all_but_the_seldom_ones():
    usual = compare.usual()
    assert {"dem", "fem", "fft", "fft-em", "maxwell", "exact", "multipole"} <= set(usual)
    assert "fem-p1" not in usual and "fem-bricks" not in compare.usual(everything=True)
    assert set(compare.usual(everything=True)) == {m.name for m in all_methods().values() if m.call != "evolve"}


def test_a_process_loads_nothing_heavy(scene):
    """The command begins in a moment: what is heavy loads with the method that needs it."""
    code = f"""
import sys
from demheat.terminal.commands import main
for words in (["--version"], ["solve", {str(scene)!r}, "--method", "exact"], ["recommend", {str(scene)!r}]):
    try:
        main(words)
    except SystemExit:
        pass
    heavy = ("numba", "gmsh", "meshio", "skfem", "pyfftw", "pandas", "matplotlib")
    print("loaded:", *(name for name in heavy if name in sys.modules))
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    said = [line for line in done.stdout.splitlines() if line.startswith("loaded:")]
    assert said == ["loaded:", "loaded:", "loaded: numba"]


def test_the_module_is_the_command(scene):
    words = [sys.executable, "-m", "demheat", "solve", str(scene), "--method", "none"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.startswith("demheat: --method none: no such method")


@pytest.mark.parametrize(
    "words, told",
    [
        ("solve --write field.xyz", "--write field.xyz: the suffix must be one of"),
        ("solve --write none/field.vti", "--write none/field.vti: there is no folder"),
        ("solve --write /proc/field.vti", "--write /proc/field.vti: must lie in a folder that can be written into"),
        ("solve --out laminate.toml", "--out laminate.toml: must be a folder, and 'laminate.toml' is a file"),
        ("compare --out /proc/new/folder", "--out /proc/new/folder: must be in a folder that can be written into"),
        ("report --out .", "--out .: is a folder"),
        ("report --out none/page.html", "--out none/page.html: there is no folder"),
    ],
)
def test_where_answers_go_is_looked_at_before_anything_is_solved(capsys, laminate, tmp_path, monkeypatch, words, told):
    if "/proc" in words and not Path("/proc/self").exists():
        pytest.skip("no folder that root cannot write into")
    monkeypatch.chdir(tmp_path)
    command, *others = words.split()
    monkeypatch.setattr(answers, "_run", None)
    status, out, err = run(capsys, command, laminate.name, "--method", "exact", *others)
    assert (status, out) == (2, "") and err.startswith(f"demheat: {told}"), err
    assert [each.name for each in tmp_path.iterdir()] == ["laminate.toml"]


def test_a_folder_is_made_when_there_is_something_to_put_there(capsys, laminate, tmp_path):
    status, _, _ = run(capsys, "solve", laminate, "--method", "rayleigh", "--out", tmp_path / "new" / "folder")
    assert status == 1 and not (tmp_path / "new").exists()
    status, _, _ = run(capsys, "solve", laminate, "--method", "exact", "--out", tmp_path / "new" / "folder")
    assert status == 0 and (tmp_path / "new" / "folder" / "exact.npz").exists()
