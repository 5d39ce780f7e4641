"""CPU seconds and peak memory of a command and of all processes that it starts."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

#: starts a command and prints its status, CPU seconds and peak: the peak of a process counts from that of the one that starts it,
#: which the bench with its libraries would be
LAUNCHER = """
import os, subprocess, sys
with open(sys.argv[1], "wb") as out, open(sys.argv[2], "wb") as err:
    process = subprocess.Popen(sys.argv[3:], stdout=out, stderr=err)
    _, status, used = os.wait4(process.pid, 0)
print(os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""


@dataclass(frozen=True)
class Measured:
    """Cost of one run of a command: CPU seconds of all its processes, and MB of the largest process at its peak."""

    cpu: float
    megabytes: float


def measured(
    words: Sequence[str | Path],
    cwd: Path,
    printed: Path | str = os.devnull,
    said: Path | str = os.devnull,
    allowed: Sequence[int] = (0,),
) -> Measured:
    """One run of a command: one thread a process, compiled modules are kept, no package of the caller's path.

    words: program and arguments.
    cwd: folder in which it runs.
    printed, said: files for its standard output and its messages.
    allowed: exit statuses that are no failure.

    Raises CalledProcessError for another status.
    """
    env = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    for name in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE"):
        env.pop(name, None)
    launcher = [sys.executable, "-S", "-E", "-c", LAUNCHER, printed, said]
    ran = subprocess.run([*launcher, *words], cwd=cwd, env=env, stdout=subprocess.PIPE, text=True, check=True)
    status, cpu, megabytes = map(float, ran.stdout.split())
    if int(status) not in allowed:
        message = Path(said).read_text(encoding="utf-8") if said != os.devnull else None
        raise subprocess.CalledProcessError(int(status), [*map(str, words)], stderr=message)
    return Measured(cpu, megabytes)
