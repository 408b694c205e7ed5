"""What a file costs a device: counts that add up, and the model against callgrind on settings it has not seen."""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from qmd_studio.codecs.compact.file import encode as encode_compact
from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.encode import encode
from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import CodecError
from qmd_studio.tuning.budget import budget_of_file, budget_of_settings, device, devices
from tests.generated_motion import walker

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


@pytest.mark.parametrize("n_frames", [1, 2, 61, 100])
@pytest.mark.parametrize(("fdf", "bits", "segment"), [(6, 8, 0), (0, 9, 20), (61, 16, 30)])
def test_budget_of_settings_is_that_of_the_file_they_make(n_frames, fdf, bits, segment):
    motion = walker(n_frames)
    settings = QmdSettings(fdf, bits, segment).checked(62, n_frames - 1)
    data = encode(motion, settings).data
    assert budget_of_settings(settings, n_frames - 1, 62, file_bytes=len(data)) == budget_of_file(data)


def test_memory_is_what_the_player_holds():
    data = encode(walker(40), QmdSettings(bits=10)).data
    budget = budget_of_file(data)
    assert (budget.table_bytes, budget.pose_bytes, budget.file_bytes) == (4096, 248, len(data))
    assert budget.ram_bytes == len(data) + 248 + budget.state_bytes
    assert budget.ram_on(device("cortex-m4")) == 248 + budget.state_bytes < 1024
    assert budget.ram_on(device("pocket-pc")) == budget.ram_bytes


def test_work_does_not_depend_on_the_encoder_and_grows_with_columns():
    paper, closed = (
        budget_of_file(encode(walker(50), QmdSettings(encoder=e)).data) for e in (Encoder.PAPER, Encoder.CLOSED)
    )
    assert paper.instructions_per_frame == closed.instructions_per_frame
    short = budget_of_settings(QmdSettings(), 100, 30, file_bytes=5000)
    long = budget_of_settings(QmdSettings(), 100, 60, file_bytes=5000)
    assert 1.3 * short.instructions_per_frame < long.instructions_per_frame < 2 * short.instructions_per_frame


def test_compact_profile_costs_less_file_and_more_work_and_memory():
    motion = walker(120)
    compact = budget_of_file(encode_compact(motion, CompactSettings(mean_error_mm=0.5)).data)
    paper = budget_of_file(encode(motion).data)
    assert compact.file_bytes < paper.file_bytes / 2
    assert compact.instructions_per_frame > 10 * paper.instructions_per_frame
    assert paper.work_bytes == 0
    assert 20_000 < compact.work_bytes < 60_000  # two blocks of up to 60 frames, the models, the key poses
    assert compact.ram_on(device("cortex-m4")) == compact.state_bytes + compact.pose_bytes + compact.work_bytes


def test_load_is_the_share_of_the_processor_s_cycles():
    budget = replace(budget_of_file(encode(walker(10)).data), instructions_per_frame=1000.0, additions_per_frame=62.0)
    slow = replace(device("pocket-pc"), megahertz=1.0, cycles_per_instruction=2.0, cycles_per_addition=10.0)
    assert budget.load_on(slow, 100.0) == pytest.approx((2000 + 620) * 100 / 1e6)


def test_every_device_plays_a_walk_with_time_to_spare():
    budget = budget_of_file(encode(walker(343)).data)
    assert set(devices()) >= {"cortex-m4", "esp32", "pocket-pc", "phone"}
    for name in devices():
        assert 0 < budget.load_on(device(name), 120.0) < 0.2
        assert budget.ram_on(device(name)) < device(name).ram_bytes


def test_unknown_device_is_told_with_those_that_are_known():
    with pytest.raises(CodecError) as caught:
        device("toaster")
    assert "cortex-m4" in caught.value.wanted


def test_model_is_within_a_tenth_of_what_callgrind_counts(tmp_path):
    if not shutil.which("valgrind") or not shutil.which("cc"):
        pytest.skip("needs valgrind and a C compiler (cc) to count instructions")
    sys.path.insert(0, str(BENCHMARKS))
    try:
        from decoder_instructions import CompactSetting, Counter, Setting, compare
    finally:
        sys.path.remove(str(BENCHMARKS))
    counter = Counter(tmp_path)
    for setting in (Setting(62, 6, 8, 120, 50), Setting(31, 2, 11, 200, 1000), CompactSetting(70, 30, 0.4, 40, seed=7)):
        assert compare(setting, counter) < 0.1
