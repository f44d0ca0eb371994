"""What films are held against Cycles by: the stand-in for a denoiser takes most noise away, adds no bias, keeps what albedo shows, and is
exact where it may be; errors are those of films, without the noise of the truth; OpenEXR files come back as they were."""
import pathlib
import sys
import tempfile
import zlib

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "blender" / "beside_cycles"))
import exr  # noqa: E402
import installed  # noqa: E402
import judge  # noqa: E402
from denoise import box, denoised  # noqa: E402

ROWS, COLUMNS = 48, 64
row, column = np.mgrid[:ROWS, :COLUMNS].astype(float)
albedo = np.where(((row // 8 + column // 8) % 2)[..., None], [0.8, 0.3, 0.2], [0.2, 0.5, 0.7])
normal = np.stack([np.sin(column / 30), np.cos(column / 30), 0 * row], -1)
features = np.concatenate([albedo, normal, row[..., None]], -1)
random = np.random.default_rng(1)


def error(picture, truth):
    return np.sqrt(np.mean((picture - truth) ** 2))


def test_means_are_those_of_squares():
    values = random.random((ROWS, COLUMNS, 2))
    assert np.allclose(box(values, 2)[10, 20], values[8:13, 18:23].mean((0, 1)))
    assert np.allclose(box(values, 2)[0, 0], values[:3, :3].mean((0, 1)))


def test_noise_goes_and_light_stays():
    truth = albedo * (0.5 + 0.4 * normal[..., :1] + np.exp(-((column - 32) ** 2 + (row - 24) ** 2) / 200)[..., None])
    halves = [truth * random.gamma(2, 0.5, truth.shape) for _ in range(2)]
    found = denoised(halves, features)
    assert error(found, truth) < error((halves[0] + halves[1]) / 2, truth) / 4
    assert abs(found.mean() / truth.mean() - 1) < 0.02


def test_a_plane_over_features_is_found_exactly():
    truth = np.repeat(0.3 + 0.01 * row[..., None] + 0.5 * albedo[..., :1], 3, -1)
    assert error(denoised([truth, truth], features), truth) < 1e-3 * truth.mean()


def test_black_pictures_and_even_features_are_no_fault():
    black = np.zeros((8, 9, 3))
    assert np.all(denoised([black, black], np.zeros((8, 9, 7))) == 0)


def test_files_come_back_as_they_were():
    picture = np.float32(random.normal(size=(5, 7, 3)))
    with tempfile.TemporaryDirectory() as folder:
        exr.write(pathlib.Path(folder) / "a.exr", exr.rgb(picture))
        found = exr.read(pathlib.Path(folder) / "a.exr")
    assert all(np.array_equal(found[c], picture[..., k]) for k, c in enumerate("RGB"))


def test_zip_is_taken_back():
    plain = random.integers(0, 4, 1001).astype(np.uint8)
    halves = np.concatenate([plain[0::2], plain[1::2]]).astype(int)
    deltas = np.concatenate([halves[:1], (np.diff(halves) + 128) & 255]).astype(np.uint8)
    assert exr.inflated(zlib.compress(deltas.tobytes()), 1001) == plain.tobytes()


def test_errors_are_those_of_films():
    shape = 3, 40, 60
    truth, constant = np.full(shape, 100.0), random.normal(0, 2, shape[1:])
    halves = [truth + random.normal(0, 8, shape) for _ in range(2)]
    still = [(*np.mgrid[:shape[1], :shape[2]], np.ones(shape[1:], bool))] * 2
    flat = judge.weights_of_rows(shape[1], None)
    steady = judge.judged(truth + constant, 10, halves, still, flat) | {"cpu": 3.0}
    changing = judge.judged(truth + random.normal(0, 2, shape), 10, halves, still, flat) | {"cpu": 3.0}
    assert abs(judge.together([steady])["psnr_y"] - 10 * np.log10(255**2 / np.mean(constant**2))) < 1
    assert judge.together([steady, changing])["bytes"] == 20
    assert judge.together([steady])["flicker"] < 1.5 and abs(judge.together([changing])["flicker"] - 2 * 2**0.5) < 0.8


def test_rows_count_by_solid_angle():
    weights = judge.weights_of_rows(90, [0, 0, 0, 0])
    assert np.isclose(weights.mean(), 1) and np.isclose(weights[29] / weights[44], np.sin(np.radians(59)) / np.sin(np.radians(89)))
    assert np.allclose(judge.weights_of_rows(45, [0, 0, 0, 0.5]) / weights[:45], weights[:45].mean() ** -1), "the upper half alone"
    truth = np.full((1, 90, 8), 100.0)
    pole, equator = truth.copy(), truth.copy()
    pole[:, 0], equator[:, 45] = 110, 110
    psnr = [judge.together([judge.judged(p, 1, [truth, truth], [], weights) | {"cpu": 1}])["psnr_y"] for p in (pole, equator)]
    assert np.isclose(psnr[0] - psnr[1], 10 * np.log10(weights[45] / weights[0]))


def test_other_metrics_have_means_and_lows_over_windows():
    assert installed.mean_and_low([]) == (None, None)
    assert installed.mean_and_low(range(1, 41)) == (20.5, 1.5)
    truth = np.full((1, 8, 8), 100.0)
    window = judge.judged(truth, 1, [truth, truth], [], judge.weights_of_rows(8, None)) | {"cpu": 1}
    found = judge.together([window | {"xpsnr_y": [40.0], "ssimulacra2": []}, window | {"xpsnr_y": [30.0], "ssimulacra2": []}])
    assert found["xpsnr_y"] == 35 and found["xpsnr_y_low"] == 30 and found["ssimulacra2"] is None


def test_equal_quality_lies_on_the_curve():
    rows = [{"cpu": cpu, "psnr_y": psnr, "flicker": flicker} for cpu, psnr, flicker in ((1, 30, 4), (4, 34, 2))]
    equal = judge.at_equal_quality({"cpu": 0.5, "psnr_y": 32, "flicker": 1.5}, rows)
    assert np.isclose(equal["times"], 4) and np.isclose(equal["flicker"], 0.5) and equal["beyond"] == ""
    assert judge.at_equal_quality({"cpu": 0.5, "psnr_y": 29, "flicker": 1}, rows)["beyond"] == "<"
    assert judge.at_equal_quality({"cpu": 0.5, "psnr_y": 35, "flicker": 1}, rows)["beyond"] == ">"


for name, test in list(globals().items()):
    if name.startswith("test_"):
        test()
