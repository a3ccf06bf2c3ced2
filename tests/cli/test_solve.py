"""``solve``: what it prints and writes, and what it says of its own answer."""

import functools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from commands import ROOT, SOLVE_FIELDS, assert_one_sentence, call, saved, small_log
from layouts import LOG_FIELDS

from npslam_teach import datasets, evaluation, pose_graph
from npslam_teach.association import count_votes, objective
from npslam_teach.cli import parser, solving
from npslam_teach.cli.method_help import MEANINGS
from npslam_teach.methods import METHODS, paper_settings, settings_for
from npslam_teach.types import RobotLog

METRICS = {
    "mean_pose_error",
    "rmse_pose_error",
    "cumulative_pose_error",
    "mean_object_error",
    "num_objects",
    "num_objects_true",
    "ari",
    "v_measure",
    "observations_used",
    "num_observations_used",
    "chi2_per_dof",
}


@pytest.mark.parametrize("method", METHODS)
def test_solve_prints_one_json_object(capsys, log_file, method):
    code, out, err = call(capsys, "solve", log_file, "--method", method, "--json")
    # These answers are far off on every log with drift, and it is said.
    expected = {"open-loop": "chi2 per degree of freedom is", "robust-slam": "are left out"}.get(method, "")
    assert code == 0 and expected in err and err.count("warning") == (method in ("open-loop", "robust-slam"))
    result = json.loads(out)
    log, truth = datasets.load_log(log_file)
    assert set(result) == SOLVE_FIELDS
    assert set(result["metrics"]) == METRICS
    assert result["method"] == method
    assert len(result["labels"]) == log.num_observations
    assert np.shape(result["poses"]) == (log.num_poses, 3)
    assert len(result["objects"]) == result["num_objects"] == result["counts_per_iteration"][-1]
    assert set(result["objects"][0]) == {"xy", "class", "votes", "num_observations"}
    used = [label for label in result["labels"] if label >= 0]
    assert sum(entry["num_observations"] for entry in result["objects"]) == len(used)
    for k, label in enumerate(result["labels"]):
        if label >= 0:
            assert result["objects"][label]["class"] == log.obs_class[k]


def test_solve_agrees_with_the_library(capsys, log_file):
    _, out, _ = call(capsys, "solve", log_file, "--alpha", "0.5", "--threshold", "0.3", "--json")
    log, _ = datasets.load_log(log_file)
    *_, last = METHODS["np-graph"](log, alpha=0.5, threshold=0.3, **settings_for(log))
    result = json.loads(out)
    assert result["labels"] == last.labels.tolist()
    assert result["chi2"] == last.chi2


def test_solve_without_truth_has_no_metrics(capsys, tmp_path):
    log, _ = small_log()
    datasets.save_log(tmp_path / "blind.npz", log)
    code, out, _ = call(capsys, "solve", tmp_path / "blind.npz", "--json")
    assert code == 0
    assert set(json.loads(out)) == SOLVE_FIELDS - {"metrics"}
    code, out, _ = call(capsys, "solve", tmp_path / "blind.npz")
    assert code == 0
    assert "no truth" in out and "valid objects" in out and "nan" not in out


@pytest.mark.parametrize("settings", ["paper", "sensor"])
def test_what_was_used_stands_in_the_answer(capsys, log_file, settings):
    _, out, _ = call(capsys, "solve", log_file, "--settings", settings, "--kernel-std", "0.25", "--json")
    log, _ = datasets.load_log(log_file)
    used = {"paper": paper_settings(), "sensor": settings_for(log)}[settings] | {"kernel_std": 0.25}
    assert json.loads(out)["settings"] == {"name": settings} | json.loads(json.dumps(used))
    _, out, _ = call(capsys, "solve", log_file, "--settings", settings, "--no-exclusive")
    assert f"settings              {settings}, kernel-std " in out and "observations one by one" in out


@pytest.mark.parametrize("method", METHODS)
def test_a_log_in_other_units_has_the_same_answer(capsys, tmp_path, method):
    """Everything that is a length, standard deviations too, times ten: the same labels, a path ten times as long."""
    log, truth = small_log()
    scale = np.array([10.0, 10.0, 1.0])
    stds = {"odometry_std": log.odometry_std * scale, "observation_std": log.observation_std * 10}
    larger = replace(log, odometry=log.odometry * scale, obs_xy=log.obs_xy * 10, **stds)
    world = replace(truth.world, object_xy=truth.world.object_xy * 10)
    datasets.save_log(tmp_path / "small.npz", log, truth)
    datasets.save_log(tmp_path / "large.npz", larger, replace(truth, world=world, poses=truth.poses * scale))
    small, large = (
        json.loads(call(capsys, "solve", tmp_path / name, "--method", method, "--json")[1])
        for name in ("small.npz", "large.npz")
    )
    assert small["labels"] == large["labels"]
    np.testing.assert_allclose(np.array(small["poses"]) * scale, large["poses"], atol=1e-8)
    assert small["chi2"] == pytest.approx(large["chi2"], rel=1e-6, abs=1e-12)
    assert 10 * small["metrics"]["mean_pose_error"] == pytest.approx(large["metrics"]["mean_pose_error"], rel=1e-6)


def test_a_truth_of_which_a_part_is_known_gives_what_it_allows(capsys, tmp_path):
    log, truth = small_log()
    fields = {name: getattr(log, name) for name in LOG_FIELDS}
    np.savez(tmp_path / "labels.npz", **fields, true_object=truth.obs_object)
    np.savez(tmp_path / "path.npz", **fields, true_poses=truth.poses[:, :2])
    _, whole, _ = call(capsys, "solve", saved(tmp_path, log, truth), "--json")
    for name, unknown in (("labels.npz", "mean_pose_error"), ("path.npz", "ari")):
        code, out, err = call(capsys, "solve", tmp_path / name, "--json")
        assert (code, err) == (0, "")
        metrics = json.loads(out)["metrics"]
        assert metrics[unknown] is None
        assert {k: v for k, v in metrics.items() if v is not None}.items() <= json.loads(whole)["metrics"].items()
        _, out, _ = call(capsys, "solve", tmp_path / name)
        assert "unknown" in out and "nan" not in out
        assert f"truth                 {log.num_poses if name == 'path.npz' else 0} of {log.num_poses} poses" in out


@pytest.mark.parametrize("method", METHODS)
def test_methods_are_compared_by_one_score_and_say_what_they_assume(capsys, log_file, method):
    log, _ = datasets.load_log(log_file)
    result = json.loads(call(capsys, "solve", log_file, "--method", method, "--json")[1])
    labels = evaluation.singletons_for_unassigned(np.array(result["labels"]))
    fitted = pose_graph.fit(log, labels)
    votes = count_votes(labels, log.obs_class, labels.max() + 1, log.num_classes)
    expected = objective(pose_graph.chi2(fitted), votes, 0.9, 1.0)
    assert result["score"] == pytest.approx(expected, rel=1e-7)
    _, out, _ = call(capsys, "solve", log_file, "--method", method)
    assert f"assumes               {METHODS[method].assumes}\n" in out
    assert f"score                 {result['score']:.2f} " in out and "objective  " not in out


def test_a_score_does_not_depend_on_the_unit_of_length(capsys, tmp_path):
    log, _ = small_log()
    scale = np.array([1000.0, 1000.0, 1.0])
    stds = {"odometry_std": log.odometry_std * scale, "observation_std": log.observation_std * 1000}
    in_mm = replace(log, odometry=log.odometry * scale, obs_xy=log.obs_xy * 1000, **stds)
    m, mm = (
        json.loads(call(capsys, "solve", saved(tmp_path, each, name=name), "--json")[1])
        for each, name in ((log, "m.npz"), (in_mm, "mm.npz"))
    )
    for name in ("score", "objective"):
        assert m[name] == pytest.approx(mm[name], rel=1e-6), name


def test_a_table_is_solved_like_any_log(capsys, tmp_path, log_file):
    log, truth = datasets.load_log(log_file)
    results = [
        json.loads(call(capsys, "solve", path, "--json")[1]) | {"seconds": 0}
        for path in (log_file, saved(tmp_path, log, truth, "run.csv"))
    ]
    assert results[0] == results[1]


def test_solve_writes_a_path_and_objects_for_other_programs(capsys, log_file, tmp_path):
    names = [tmp_path / name for name in ("path.tum", "objects.csv", "result.json", "graph.g2o")]
    code, out, _ = call(capsys, "solve", log_file, "--json", *(word for name in names for word in ("--out", name)))
    assert code == 0
    result = json.loads(out)
    np.testing.assert_array_equal(np.loadtxt(names[0])[:, 1:3], np.array(result["poses"])[:, :2])
    rows = names[1].read_text().splitlines()
    assert rows[0] == "object,x,y,class,num_observations" and len(rows) == 1 + result["num_objects"]
    assert json.loads(names[2].read_text()) == result
    assert len(datasets.load_g2o(names[3]).landmarks) == result["num_objects"]


def test_solve_draws_my_log(capsys, log_file, tmp_path):
    code, _, err = call(capsys, "solve", log_file, "--figures", tmp_path / "mine")
    assert (code, err) == (0, "")
    names = {f"{name}.{suffix}" for name in ("map", "iterations") for suffix in ("png", "svg")}
    assert {path.name for path in (tmp_path / "mine").iterdir()} == names
    assert_one_sentence(*call(capsys, "solve", log_file, "--figures", log_file), "expected the name of a folder")


def test_an_alternation_that_was_cut_short_says_so(capsys, log_file):
    _, out, err = call(capsys, "solve", log_file, "--iterations", "1", "--json")
    assert json.loads(out)["settled"] is False and "stopped after 1 iterations while labels were still" in err
    _, out, err = call(capsys, "solve", log_file, "--iterations", "20", "--json")
    assert json.loads(out)["settled"] is True and err == ""
    _, out, _ = call(capsys, "solve", log_file, "--method", "open-loop", "--json")
    assert json.loads(out)["settled"] is None


def test_a_threshold_that_can_merge_nothing_says_so(capsys, log_file):
    _, out, err = call(capsys, "solve", log_file, "--threshold", "0.6", "--json")
    assert "--threshold 0.6: expected less than 0.526" in err
    assert "nothing was merged: every observation is an object of its own" in err
    assert json.loads(out)["num_objects"] == json.loads(out)["num_observations"]


@pytest.fixture
def two_chairs(tmp_path):
    """A robot that stands still and sees two chairs half a metre apart, fifty times."""
    rng, times = np.random.default_rng(0), np.repeat(np.arange(50), 2)
    seen = np.tile([[1.0, 0.25], [1.0, -0.25]], (50, 1)) + rng.normal(0, 0.05, (100, 2))
    log = RobotLog(np.zeros((49, 3)), times, seen, np.zeros(100, int), 1, [0.01, 0.01, 0.01], [0.05, 0.05])
    datasets.save_log(tmp_path / "two_chairs.npz", log)
    return tmp_path / "two_chairs.npz"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--method", "open-loop", "--threshold", "0"), r"chi2 per degree of freedom is 1\d\.\d: the noise in the log"),
        (("--method", "robust-slam", "--threshold", "1"), "only 1 of 100 observations are of an object in this answer"),
        (("--seed", "3"), "--seed has no effect without --noise or --restarts"),
        (("--kernel-std", "5"), r"the kernel is 5 m wide, more than all that was seen \(0\.\d+ m\); classes alone"),
    ],
)
def test_an_answer_that_is_none_says_so(capsys, two_chairs, arguments, said):
    """By settings that lose them."""
    code, _, err = call(capsys, "solve", two_chairs, *arguments)
    assert code == 0 and re.search(said, err) and err.count("warning") == 1


def test_a_noise_beyond_all_bounds_is_named(refused, tmp_path, log_file):
    assert "odometry_std: expected at most 100000, got" in refused("solve", log_file, "--odometry-std", "1e9,1e9,1e9")
    log, _ = small_log()
    datasets.save_log(tmp_path / "run.npz", replace(log, observation_std=[1e9, 1e9]))
    assert "observation_std: expected at most 10000, got" in refused("solve", tmp_path / "run.npz")


def test_restarts_keep_the_lowest_objective(capsys, log_file):
    result, again = (
        json.loads(call(capsys, "solve", log_file, "--restarts", "5", "--json")[1]) | {"seconds": 0} for _ in range(2)
    )
    assert result == again
    assert len(result["restarts"]) == 5
    assert result["objective"] == min(each["objective"] for each in result["restarts"])
    _, out, _ = call(capsys, "solve", log_file, "--restarts", "5")
    assert "restarts              5 orders: " in out
    assert_one_sentence(*call(capsys, "solve", log_file, "--restarts", "5", "--method", "ekf"), "--order", "ekf")


def test_the_filter_ends_with_the_smoothed_graph(capsys, log_file):
    smoothed, raw = (
        json.loads(call(capsys, "solve", log_file, "--method", "ekf", "--json", *more)[1])
        for more in ((), ("--filter-only",))
    )
    assert smoothed["labels"] == raw["labels"] and smoothed["chi2"] <= raw["chi2"]
    log, _ = datasets.load_log(log_file)
    best = pose_graph.fit(log, np.array(raw["labels"]), np.array(raw["poses"]))
    assert smoothed["chi2"] == pytest.approx(pose_graph.chi2(best), rel=1e-9)


def test_nan_becomes_null(capsys, log_file):
    code, out, _ = call(capsys, "solve", log_file, "--method", "frame-by-frame", "--json")
    assert json.loads(out)["metrics"]["chi2_per_dof"] is None


def test_solve_adds_the_same_noise_for_the_same_seed(capsys, log_file):
    arguments = ["solve", log_file, "--noise", "1", "--json", "--seed"]
    first, again, other = (json.loads(call(capsys, *arguments, seed)[1]) for seed in (3, 3, 4))
    assert first["poses"] == again["poses"]
    assert first["poses"] != other["poses"]


def test_solve_for_people(capsys, log_file):
    code, out, err = call(capsys, "solve", log_file)
    assert (code, err) == (0, "")
    assert "mean pose error" in out and " m\n" in out
    assert "->" in out


def test_solve_writes_its_result(capsys, log_file, tmp_path):
    code, out, _ = call(capsys, "solve", log_file, "--json", "--out", tmp_path / "result.json")
    assert code == 0
    assert json.loads((tmp_path / "result.json").read_text()) == json.loads(out)
    code, out, _ = call(capsys, "solve", log_file, "--json", "--out", tmp_path / "result.g2o")
    graph = datasets.load_g2o(tmp_path / "result.g2o")
    assert pose_graph.chi2(graph) == pytest.approx(json.loads(out)["chi2"], rel=1e-9)


def test_nothing_is_replaced_without_a_word(capsys, log_file, tmp_path):
    out = tmp_path / "result.json"
    assert call(capsys, "solve", log_file, "--json", "--out", out)[2] == ""
    before = out.read_text()
    code, _, err = call(capsys, "solve", log_file, "--alpha", "0.5", "--json", "--out", out)
    assert code == 0 and err.startswith("npslam_teach solve: warning: --out ") and "replaces the file that is" in err
    assert out.read_text() != before
    pictures = tmp_path / "pictures"
    assert call(capsys, "solve", log_file, "--figures", pictures)[2] == ""
    assert "the folder is not empty" in call(capsys, "solve", log_file, "--figures", pictures)[2]


@pytest.mark.parametrize("names", [("a.json", "a.json"), ("a.json", "../{}/a.json")])
def test_one_file_cannot_be_written_twice(capsys, log_file, tmp_path, names):
    outs = [word for name in names for word in ("--out", tmp_path / name.format(tmp_path.name))]
    assert_one_sentence(*call(capsys, "solve", log_file, *outs), "--out", "expected every file once")
    assert not list(tmp_path.glob("a.json"))


@pytest.mark.parametrize("method", ["np-graph", "open-loop"])
def test_the_truth_costs_no_second_fit(capsys, log_file, monkeypatch, method):
    """One refit serves the score and the metrics, and gives what ``evaluate`` finds by itself."""
    expected = json.loads(call(capsys, "solve", log_file, "--method", method, "--json")[1])
    log, truth = datasets.load_log(log_file)
    known = METHODS[method].settings
    *_, last = METHODS[method](log, **{n: v for n, v in settings_for(log).items() if known.get(n) is not None})
    own = evaluation.evaluate(last, truth, log).chi2_per_dof
    monkeypatch.setattr("npslam_teach.evaluation.metrics.fit", None)
    result = json.loads(call(capsys, "solve", log_file, "--method", method, "--json")[1])
    assert result["metrics"] == expected["metrics"]
    assert result["metrics"]["chi2_per_dof"] == result["chi2_per_dof"] == pytest.approx(own, rel=1e-9)


def test_the_table_in_the_readme_is_a_log(capsys, tmp_path):
    (table,) = re.findall(r"```\n(kind,time.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    (tmp_path / "run.csv").write_text(table, encoding="utf-8")
    result = json.loads(call(capsys, "solve", tmp_path / "run.csv", "--json")[1])
    assert (result["num_observations"], result["num_objects"]) == (2, 1)


def test_samples_of_the_posterior(capsys, log_file):
    code, out, err = call(capsys, "solve", log_file, "--method", "posterior", "--samples", "64", "--json")
    assert (code, err) == (0, "")
    sampled = json.loads(out)["posterior"]
    assert sum(sampled["num_objects_probability"].values()) == pytest.approx(1.0)
    assert np.shape(sampled["together"]) == (len(sampled["best"]),) * 2
    assert len(sampled["objects"]) == max(sampled["best"]) + 1
    assert set(sampled["r_hat"]) == set(sampled["effective_sample_size"]) == {"num_objects", "log_posterior"}
    code, out, _ = call(capsys, "solve", log_file, "--method", "posterior", "--samples", "64")
    assert code == 0
    assert re.search(r"number of objects     \d+ \(\d\.\d{3}\)", out)
    assert "in 4 chains, R-hat" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--samples", "100"], "--samples: expected the method posterior, got np-graph"),
        (["--method", "posterior", "--samples", "3"], "--samples: expected at least 16, got 3"),
        (["--method", "ekf", "--starts", "2"], "--starts: expected a method that has it, got ekf"),
    ],
)
def test_samples_that_make_no_sense(refused, log_file, arguments, words):
    assert words in refused("solve", log_file, *arguments)


def test_a_single_search_is_not_taken_for_certain(capsys, log_file):
    _, _, err = call(capsys, "solve", log_file, "--method", "posterior", "--starts", "1")
    assert "all 1 searches were needed, and the best partition may not have been found twice; see --starts" in err
    _, _, err = call(capsys, "solve", log_file, "--method", "posterior")
    assert err == ""


@pytest.mark.slow
def test_estimated_noise_is_used_and_told(capsys, tmp_path, monkeypatch):
    """A log that claims a third of its noise. It is estimated once, and told in both ways."""
    estimate = functools.cache(lambda: solving_estimate(*asked[0]))
    solving_estimate, asked = solving.estimate_noise, []
    monkeypatch.setattr(solving, "estimate_noise", lambda *log: asked.append(log) or estimate())
    short_log, _ = small_log()
    path = tmp_path / "run.npz"
    third = {name: getattr(short_log, name) / 3 for name in ("odometry_std", "observation_std")}
    datasets.save_log(path, replace(short_log, **third))
    code, out, _ = call(capsys, "solve", path, "--method", "ekf", "--estimate-noise", "--json")
    found = json.loads(out)["estimated_noise"]
    assert code == 0 and found["is_white"]
    np.testing.assert_allclose(found["observation_std"], short_log.observation_std, rtol=0.25)
    code, out, err = call(capsys, "solve", path, "--method", "ekf")
    assert "chi2 per degree of freedom is" in err and "--estimate-noise" in err
    _, out, err = call(capsys, "solve", path, "--method", "ekf", "--estimate-noise")
    assert re.search(r"^estimated noise +odometry [\d. ]+, observation [\d. ]+$", out, re.M) and err == ""
    assert len(asked) == 2


def test_estimated_noise_beside_settings_that_ignore_it_is_refused(refused, log_file):
    said = refused("solve", log_file, "--settings", "paper", "--estimate-noise")
    assert "--estimate-noise: expected --settings sensor" in said


def test_class_probabilities_without_effect_are_told(capsys, tmp_path):
    log, _ = small_log()
    path, even = tmp_path / "run.npz", np.full((log.num_observations, log.num_classes), 1 / log.num_classes)
    datasets.save_log(path, replace(log, class_probabilities=even))
    for method, registered in METHODS.items():
        _, _, err = call(capsys, "solve", path, "--method", method)
        assert ("class_probabilities of the log have no effect" in err) != registered.sees_classes


def test_headings_without_effect_are_told(capsys, tmp_path):
    log, _ = small_log()
    path = tmp_path / "run.npz"
    datasets.save_log(path, replace(log, obs_theta=np.zeros(log.num_observations), observation_theta_std=0.3))
    for method, registered in METHODS.items():
        code, out, err = call(capsys, "solve", path, "--method", method, "--json")
        assert ("takes objects for points: obs_theta of the log has no effect" in err) != registered.sees_headings
        assert code == 0 and all(len(each["xy"]) == 2 for each in json.loads(out)["objects"])
        assert all(("theta" in each) == registered.sees_headings for each in json.loads(out)["objects"])
    said = call(capsys, "solve", path, "--out", tmp_path / "graph.g2o")
    assert said[0] == 2 and "expected landmarks without headings" in said[2]


def test_covariances_without_effect_are_told(capsys, tmp_path):
    log, _ = small_log()
    path, cov = tmp_path / "run.npz", np.tile(0.01 * np.eye(2), (log.num_observations, 1, 1))
    datasets.save_log(path, replace(log, observation_cov=cov))
    _, _, err = call(capsys, "solve", path)
    assert "np-graph assumes one noise for all: observation_cov of the log have no effect" in err
    _, _, err = call(capsys, "solve", path, "--method", "ekf")
    assert "have no effect" not in err


def test_help_says_what_each_option_means_for_each_method(capsys):
    """Neither an option that a method refuses, nor one that it takes and nothing is said about."""
    beside = {"np-graph": {"restarts"}, "ekf": {"filter-only"}, "posterior": {"samples"}}
    for name, method in METHODS.items():
        taken = {option.replace("_", "-") for option in method.settings if option in solving.GIVEN}
        taken |= {"iterations"} & set(method.settings)
        assert set(MEANINGS[name]) == taken | beside.get(name, set()), name
    with pytest.raises(SystemExit) as stopped:
        parser.main(["solve", "--help"])
    out = capsys.readouterr().out
    assert stopped.value.code == 0
    words = " ".join(out.split())
    for name, method in METHODS.items():
        assert f"{name}: {method.assumes}" in words
        assert all(f"--{option}: {meaning}" in words for option, meaning in MEANINGS[name].items())
