"""The network: weights files, training that goes on, the detector with any weights."""

from __future__ import annotations

import importlib.util
import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import safetensors.torch
import torch
from momantu_skills.detect_object import DetectObject
from momantu_skills.perception.evaluation import boxes, measure, precision
from momantu_skills.perception.learned import examples, training, weights
from momantu_skills.perception.learned.crops import STEP, channels
from momantu_skills.perception.learned.detector import WEIGHTS, LearnedDetector
from momantu_skills.perception.learned.header import KIND, VERSION, WeightsError
from momantu_skills.perception.learned.network import Network, classes_of
from momantu_worlds.labelled.studio import Studio

from momantu_bt import labelled
from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.cli import main
from momantu_bt.detector import DETECTORS, known_categories
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass
from momantu_bt.testing import ScriptedRobot, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Round
from momantu_bt.world import Surface


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with four pictures."""
    folder = tmp_path_factory.mktemp("pictures")
    studio = Studio(["four_rooms"], testing=False)
    for seed in range(4):
        labelled.write(folder, studio.picture(seed))
    return folder


@pytest.fixture
def any_weights(tmp_path: Path) -> Path:
    """Weights of a network that has learned nothing."""
    torch.manual_seed(0)
    path = tmp_path / "any.safetensors"
    weights.save(path, Network(), {"about": "random"})
    return path


def test_weights_come_back_with_their_card(any_weights: Path) -> None:
    torch.manual_seed(0)
    fresh = Network().state_dict()
    back = weights.load(any_weights).state_dict()
    assert all(torch.allclose(back[name], fresh[name], atol=1e-2) for name in fresh)
    assert weights.card(any_weights) == {"about": "random"}
    assert any_weights.stat().st_size < 20e6


def spoil(path: Path, how: str) -> None:
    told = {"kind": f"{KIND} {VERSION}", "categories": json.dumps(dict(USUAL))}
    if how == "missing":
        path.unlink()
    elif how == "text":
        path.write_text("no weights")
    elif how == "cut":
        path.write_bytes(path.read_bytes()[:5000])
    elif how == "foreign":
        safetensors.torch.save_file({"a": torch.zeros(3)}, path)
    elif how == "version":
        safetensors.torch.save_file({"a": torch.zeros(3)}, path, metadata={"kind": f"{KIND} 1"})
    elif how == "other network":
        found = safetensors.torch.load_file(path)
        found.pop("head.bias")
        safetensors.torch.save_file(found, path, metadata=told)
    else:
        found = safetensors.torch.load_file(path)
        found["head.bias"][0] = float("nan")
        safetensors.torch.save_file(found, path, metadata=told)


@pytest.mark.parametrize(
    ("how", "code", "said"),
    [
        ("missing", "WEIGHTS_BROKEN", "cannot be read"),
        ("text", "WEIGHTS_BROKEN", "cannot be read"),
        ("cut", "WEIGHTS_BROKEN", "cannot be read"),
        ("foreign", "WEIGHTS_FOREIGN", "holds no weights of the learned detector"),
        ("version", "WEIGHTS_OUTDATED", "of version 1, this detector uses version 3"),
        ("other network", "WEIGHTS_FOREIGN", "another network: 'head.bias'"),
        ("nan", "WEIGHTS_BROKEN", "not finite"),
    ],
)
def test_a_wrong_weights_file_is_told(how: str, code: str, said: str, any_weights: Path) -> None:
    spoil(any_weights, how)
    with pytest.raises(WeightsError, match=said) as raised:
        weights.load(any_weights)
    assert raised.value.code == code


def test_evaluate_tells_a_wrong_weights_file(
    pictures: Path,
    any_weights: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    spoil(any_weights, "text")
    monkeypatch.setenv(WEIGHTS, str(any_weights))
    command = ["perception", "evaluate", "--detector", "learned", "--seeds", "0:1"]
    assert main([*command, "--pictures", str(pictures)]) == 2
    assert str(any_weights) in capsys.readouterr().err


def test_any_weights_give_figures(
    pictures: Path, any_weights: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(WEIGHTS, str(any_weights))
    command = ["perception", "evaluate", "--detector", "learned", "--seeds", "0:2"]
    assert main([*command, "--pictures", str(pictures)]) == 0


def test_the_detector_is_a_plug_in_that_knows_its_categories() -> None:
    assert DETECTORS.load("learned") is LearnedDetector
    assert set(LearnedDetector.categories) <= set(known_categories() or ())


def test_torch_is_imported_with_the_first_picture_alone() -> None:
    program = (
        "import sys; from momantu_bt.detector import DETECTORS, known_categories; "
        "known_categories(); DETECTORS.load('learned')(); DETECTORS.load('geometric')(); "
        "sys.exit('torch' in sys.modules or 'safetensors' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
    assert importlib.util.find_spec("torch") is not None


def test_crops_fit_the_network(pictures: Path) -> None:
    for seed in range(4):
        example = examples.example(labelled.read(pictures, seed))
        assert example is not None
        seen, made = example.arrays(classes_of(USUAL))
        assert seen.shape[1] % STEP == seen.shape[2] % STEP == 0
        assert made.classes.shape == (seen.shape[1] // 2, seen.shape[2] // 2)
        assert np.isfinite(seen).all()
        assert np.array_equal(seen, channels(example.crop))
        shown = np.unique(made.things[made.things >= 0])
        assert len(shown) >= 1


def test_kept_crops_are_the_same(pictures: Path) -> None:
    fresh = examples.kept(pictures, 0)
    again = examples.kept(pictures, 0)
    assert fresh is not None
    assert again is not None
    (one, first), (other, second) = (e.arrays(classes_of(USUAL)) for e in (fresh, again))
    assert np.array_equal(one, other)
    assert np.allclose(first.coordinates, second.coordinates, atol=1e-6)
    damaged = pictures / examples.FOLDER / "000000.npz"
    damaged.write_bytes(damaged.read_bytes()[:1000])
    assert examples.kept(pictures, 0) is not None


def trained(pictures: Path, plan: training.Plan, state: Path) -> training.Training:
    made = training.begin(pictures, plan, "cpu")
    if state.exists():
        training.resume(made, state)
    training.go_on(made, state, lambda line: None)
    return made


def test_an_interrupted_training_ends_as_a_whole_one(pictures: Path, tmp_path: Path) -> None:
    plan = training.Plan(epochs=2, batch=2, rate=1e-3, seed=3)
    whole = trained(pictures, plan, tmp_path / "whole.state")
    part = training.begin(pictures, plan, "cpu")
    batches = training._batches(part)
    training._step(part, next(batches))
    training.keep(part, tmp_path / "part.state")
    rest = trained(pictures, plan, tmp_path / "part.state")
    assert rest.step == whole.step == 4
    for name, value in whole.network.state_dict().items():
        assert torch.allclose(value, rest.network.state_dict()[name], atol=1e-5), name


def test_a_training_ends_before_its_plan_and_goes_on(pictures: Path, tmp_path: Path) -> None:
    plan = training.Plan(epochs=3, batch=2, rate=1e-3, seed=3)
    whole = trained(pictures, plan, tmp_path / "whole.state")
    part = training.begin(pictures, plan, "cpu")
    part.stop = 3
    training.go_on(part, tmp_path / "part.state", lambda line: None)
    assert part.step == 3
    rest = trained(pictures, plan, tmp_path / "part.state")
    assert rest.step == whole.step == 6
    for name, value in whole.network.state_dict().items():
        assert torch.allclose(value, rest.network.state_dict()[name], atol=1e-5), name


def test_weights_that_learned_go_on_with_another_category(any_weights: Path) -> None:
    known = weights.load(any_weights)
    more = known.knowing({**USUAL, "spray": Symmetry.NONE})
    assert more.classes == ("nothing", *USUAL, "spray", "handle")
    seen = torch.zeros(1, 9, 32, 32)
    (scores, *rest), (others, *same) = known(seen), more(seen)
    assert all(torch.equal(one, other) for one, other in zip(rest, same, strict=True))
    assert torch.equal(scores[:, :6], others[:, :6])
    assert torch.equal(scores[:, 6], others[:, 7])
    path = any_weights.with_name("more.safetensors")
    weights.save(path, more, {})
    assert weights.load(path).categories == more.categories


def test_the_categories_are_those_of_the_weights(
    any_weights: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    weights.save(any_weights, Network({**USUAL, "spray": Symmetry.NONE}), {})
    assert LearnedDetector.categories == tuple(USUAL)
    assert LearnedDetector(any_weights).categories == (*USUAL, "spray")
    monkeypatch.setenv(WEIGHTS, str(any_weights))
    assert "spray" in (known_categories() or ())


def test_train_writes_weights_that_can_be_used(pictures: Path, tmp_path: Path) -> None:
    out = tmp_path / "mine.safetensors"
    command = ["perception", "train", str(pictures), "-o", str(out), "--epochs", "1"]
    assert main([*command, "--batch", "2"]) == 0
    assert weights.card(out)["pictures"] == 4
    weights.load(out)


def test_a_training_that_cannot_begin_is_told(
    pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "mine.safetensors"
    assert main(["perception", "train", str(tmp_path), "-o", str(out)]) == 2
    assert "perception render" in capsys.readouterr().err
    command = ["perception", "train", str(pictures), "-o", str(out)]
    if not torch.cuda.is_available():
        assert main([*command, "--device", "cuda"]) == 2
        assert "no GPU can be used" in capsys.readouterr().err
    assert main([*command, "--device", "tpu"]) == 2
    assert "expected cpu or cuda" in capsys.readouterr().err
    (tmp_path / "mine.safetensors.state").write_text("no state")
    assert main(command) == 2
    assert "cannot be read" in capsys.readouterr().err
    training.keep(
        training.begin(pictures, training.Plan(epochs=9), "cpu"),
        tmp_path / "mine.safetensors.state",
    )
    assert main(command) == 2
    assert "belongs to a training with 4 pictures" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("how", "asked", "code", "said"),
    [
        ("text", "can", "WEIGHTS_BROKEN", "cannot be read"),
        ("foreign", "can", "WEIGHTS_FOREIGN", "holds no weights of the learned detector"),
        ("version", "can", "WEIGHTS_OUTDATED", "of version 1"),
        ("", "spray", "CATEGORY_UNKNOWN", "know no 'spray'; they know bottle, bowl, can, mug, box"),
    ],
)
def test_a_search_says_why_the_weights_cannot_be_used(
    how: str,
    asked: str,
    code: str,
    said: str,
    onlooker: Callable[..., ScriptedRobot],
    seen_scene: Callable[[], object],
    any_weights: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if how:
        spoil(any_weights, how)
    monkeypatch.setenv(WEIGHTS, str(any_weights))
    table = Surface(Pose2D(1.0, 0.0, 0.0), (0.6, 1.2), 0.72, (math.pi,))
    things = [Block((0.6, 1.2, 0.03), (1.0, 0.0, 0.705)), Round((0.95, 0.2, 0.72), 0.13, 0.035)]
    result = run_skill(
        DetectObject,
        robot=onlooker(things),
        site=scripted_site(surfaces={"table": table}),
        services={"planning_scene": seen_scene(), "localization": object()},
        inputs={"object": ObjectClass(asked), "on": "table", "detector": "learned"},
    )
    assert result.failure.code == code
    assert any_weights.name in result.failure.message
    assert said in result.failure.message


def test_the_bundled_weights_are_small_and_say_how_they_were_made() -> None:
    assert weights.BUNDLED.stat().st_size < 20e6
    told = weights.card(weights.BUNDLED)
    assert "perception render" in told["data"]
    assert "perception train" in told["command"]
    assert set(told["figures"]) == set(precision.MEASURES)


def test_the_bundled_weights_find_most_things(pictures: Path) -> None:
    right, things = 0, 0
    for seed in range(4):
        picture = measure.measured(labelled.read(pictures, seed), LearnedDetector())
        for true in picture.true:
            near = [one for one, _ in picture.found if boxes.distance(one, true) < 0.03]
            things += 1
            right += true.category in {one.category for one in near}
    assert right > 0.6 * things


def test_the_same_picture_gives_the_same_answer(pictures: Path) -> None:
    made = labelled.read(pictures, 1)
    first, again = (measure.measured(made, LearnedDetector()).found for _ in range(2))
    assert [score for _, score in first] == [score for _, score in again]
    for (one, _), (other, _) in zip(first, again, strict=True):
        assert one.size == other.size
        assert np.array_equal(one.pose.position, other.pose.position)
