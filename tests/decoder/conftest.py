import re

import pytest

from tests.decoder.c_decoder import ROOT, SANITISED, SOURCES, CDecoder, compile_c, compiler


@pytest.fixture(scope="session")
def c_compiler():
    """The path of a C compiler; without one the test is skipped."""
    path = compiler()
    if path is None:
        pytest.skip("no C compiler (cc, gcc or clang) to build the decoder with")
    return path


def running(folder, flags):
    program = folder / "driver"
    driver = ROOT / "tests" / "decoder" / "driver.c"
    complaint = compile_c(program, driver, SOURCES / "qmd_decoder.c", flags=flags)
    if re.search(r"cannot find .*(asan|ubsan)|(unrecognized|unsupported).*sanitize", complaint):
        pytest.skip("this C compiler comes without the address and undefined-behaviour sanitisers")
    assert not complaint
    return CDecoder(program)


@pytest.fixture(scope="session")
def sanitised(c_compiler, tmp_path_factory):
    """The decoder under the address and undefined-behaviour sanitisers."""
    decoder = running(tmp_path_factory.mktemp("sanitised"), SANITISED)
    yield decoder
    decoder.close()


@pytest.fixture(scope="session")
def optimised(c_compiler, tmp_path_factory):
    """The decoder as fast as the compiler can make it for this machine."""
    decoder = running(tmp_path_factory.mktemp("optimised"), ("-O3", "-march=native"))
    yield decoder
    decoder.close()
