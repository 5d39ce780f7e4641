"""Memory of the local page over random changes of a cylindrical pair: `python scripts/explore_memory.py [--minutes 10]`.

It speaks to the process for heavy work as the server does, waits for each answer, and prints its resident memory every minute.
The first minute fills what is kept on purpose; growth is counted from its end.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import time
from pathlib import Path

from gearmesh.explore.explorer import origin_of_file
from gearmesh.explore.frames import read_frame, write_frame

ROOT = Path(__file__).parents[1]
#: time after which growth is counted, s
WARM_S = 60.0


def resident_mb(process: int) -> float:
    """Resident memory of a process, MB."""
    lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS")).split()[1]) / 1000.0


def main() -> None:
    """Change keys at random and print memory."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    end = parser.parse_args().minutes * 60.0
    origin, chance = origin_of_file(ROOT / "samples" / "helical.toml"), random.Random(57)
    command = [sys.executable, "-m", "gearmesh.explore.worker"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        write_frame(process.stdin, json.dumps({"opened": vars(origin)}).encode())
        begun, told, first, count, refused = time.monotonic(), 0.0, None, 0, 0
        while (now := time.monotonic() - begun) < end:
            keys = {
                **origin.shown,
                "pinion.teeth": chance.randint(12, 40),
                "pinion.profile_shift": round(chance.uniform(-0.3, 0.5), 3),
                "helix_angle": round(chance.uniform(0.0, 30.0), 2),
                "assembly.dx": round(chance.uniform(0.0, 0.1), 3),
            }
            count += 1
            request = {"do": "show", "from": "opened", "keys": keys, "have": [], "job": count}
            write_frame(process.stdin, json.dumps(request).encode())
            kind = ""
            while kind != "end":
                answer = read_frame(process.stdout)
                assert answer is not None, "the process ended"
                kind = json.loads(answer.partition(b"\n")[0])["type"]
                refused += kind == "refused"
            if now - told >= 60.0:
                told, here = now, resident_mb(process.pid)
                first = here if first is None and now >= WARM_S else first
                print(f"{now / 60:5.1f} min, {count} changes, {refused} refused: {here:.0f} MB", flush=True)
        here = resident_mb(process.pid)
        print(
            f"{count} changes, {refused} refused: {here:.0f} MB, growth {here - (first or here):.0f} MB after {WARM_S:g} s"
        )
        process.stdin.close()


if __name__ == "__main__":
    main()
