"""Fuzzes the C decoder: `make fuzz-decoder N=1000000`. libFuzzer where clang is, else a mutator of our own.

Needs a C compiler and nothing else. Whatever breaks ends the run with a report; libFuzzer leaves the input in out/.
"""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OUT = ROOT / "out" / "fuzz-decoder"
FOLDERS = [ROOT / "tests/codecs/golden", HERE / "golden"]
SEEDS = [path for folder in FOLDERS for path in sorted(folder.glob("*.qmd"))]
SOURCES = [HERE / "fuzz_decoder.c", ROOT / "resources/decoder/qmd_decoder.c"]
FLAGS = ["-std=c99", "-O1", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all", f"-I{ROOT / 'resources/decoder'}"]


def main() -> int:
    """Build the target, run it, and return its exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", type=int, default=1_000_000, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="S")
    parser.add_argument("--own-mutator", action="store_true", help="even where clang is")
    wishes = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}  # finding leaks needs rights a container lacks
    clang = None if wishes.own_mutator else shutil.which("clang")
    if clang and _built(clang, ["-fsanitize=fuzzer,address,undefined"]):
        corpus = OUT / "corpus"
        corpus.mkdir(exist_ok=True)
        command = [
            OUT / "fuzz",
            f"-runs={wishes.inputs}",
            f"-seed={wishes.seed}",
            "-max_len=16384",
            "-print_final_stats=1",
        ]
        command += [f"-artifact_prefix={OUT}/", "-verbosity=1", corpus, *FOLDERS]
    elif (compiler := shutil.which("gcc") or shutil.which("cc")) and _built(
        compiler, ["-fsanitize=address,undefined", "-DQMD_OWN_MUTATOR"]
    ):
        command = [OUT / "fuzz", str(wishes.inputs), str(wishes.seed), *SEEDS]
    else:
        print("no C compiler with sanitisers (clang or gcc) to build the fuzzer with", file=sys.stderr)
        return 1
    return subprocess.run([str(word) for word in command], env=environment).returncode


def _built(compiler: str, more: list[str]) -> bool:
    words = [compiler, *FLAGS, *more, *map(str, SOURCES), "-o", str(OUT / "fuzz")]
    done = subprocess.run(words, capture_output=True, text=True)
    print(
        f"-- {Path(compiler).name} {' '.join(more)}{': ' + done.stderr.strip() if done.returncode else ''}", flush=True
    )
    return done.returncode == 0


if __name__ == "__main__":
    raise SystemExit(main())
