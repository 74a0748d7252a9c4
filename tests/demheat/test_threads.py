import os
import subprocess
import sys

import pytest

CODE = "import demheat.threads, numba; print(numba.config.THREADING_LAYER)"


@pytest.mark.parametrize("asked, given", [(None, "workqueue"), ("omp", "omp")])
def test_layer_is_workqueue_unless_asked_otherwise(asked, given):
    env = {name: value for name, value in os.environ.items() if name != "NUMBA_THREADING_LAYER"}
    if asked:
        env["NUMBA_THREADING_LAYER"] = asked
    result = subprocess.run([sys.executable, "-c", CODE], env=env, capture_output=True, text=True, check=True)
    assert result.stdout.strip() == given
