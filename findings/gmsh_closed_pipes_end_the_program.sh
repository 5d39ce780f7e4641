#!/usr/bin/env bash
# gmsh 4.15.2: after `gmsh.initialize` a Python program ends without a word where it writes to a pipe whose reader has gone.
# Expected: Python ignores SIGPIPE, so that a write to a closed pipe raises BrokenPipeError, which programs catch: a helper process
#   that has ended is started again. A mesher has no business with this signal; with `interruptible` it takes SIGINT, as its help says.
# Seen: `gmsh.initialize` gives SIGPIPE its default action, with `interruptible=False` too, and `gmsh.finalize` does not undo it.
#   `signal.getsignal` still says that it is ignored. The next write to a closed pipe ends the program: status -13, no traceback,
#   no exit handlers. Importing gmsh alone changes nothing.
# Versions: gmsh 4.15.2.
# Meets: whoever drives another process from the one that meshes: off-screen drawing, a solver behind a pipe, pools of workers, and
#   command-line tools whose output goes to `head`.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q gmsh==4.15.2
cd "$folder"
"$folder/venv/bin/python" - <<'END'
import subprocess
import sys

PROGRAM = """
import os, signal, sys
import gmsh

if sys.argv[1] != "imported":
    gmsh.initialize(interruptible=False)
if sys.argv[1] == "finalized":
    gmsh.finalize()
assert signal.getsignal(signal.SIGPIPE) == signal.SIG_IGN
reading, writing = os.pipe()
os.close(reading)
try:
    os.write(writing, b"x")
except BrokenPipeError:
    print("BrokenPipeError")
"""

seen = {}
for state in ("imported", "initialized", "finalized"):
    done = subprocess.run([sys.executable, "-c", PROGRAM, state], capture_output=True, text=True)
    seen[state] = (done.returncode, done.stdout.strip(), done.stderr.strip())
    print(state, seen[state])
assert seen == {"imported": (0, "BrokenPipeError", ""), "initialized": (-13, "", ""), "finalized": (-13, "", "")}
END
