"""Build the script that draws the report page's three-dimensional view: three.js, only what the page uses, as one classic script.

python scripts/build_three.py

Takes three and esbuild in the versions below from the npm registry into a temporary folder and writes three.min.js and
three.LICENSE.txt beside the page's other files. Needs node and npm; whoever only uses gearmesh needs neither.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

TARGET = Path(__file__).parents[1] / "gearmesh" / "view" / "report"
VERSIONS = {"three": "0.187.0", "esbuild": "0.28.2"}
#: what `scene.js` beside the script uses
NAMES = [
    "AmbientLight",
    "BufferAttribute",
    "BufferGeometry",
    "Color",
    "DataTexture",
    "DirectionalLight",
    "DoubleSide",
    "FrontSide",
    "Group",
    "InstancedMesh",
    "LinearFilter",
    "LineBasicMaterial",
    "LineSegments",
    "Matrix4",
    "Mesh",
    "MeshBasicMaterial",
    "MeshPhongMaterial",
    "PerspectiveCamera",
    "Plane",
    "Quaternion",
    "Raycaster",
    "Scene",
    "ShaderMaterial",
    "SphereGeometry",
    "Vector2",
    "Vector3",
    "WebGLRenderer",
]
ENTRY = f"""
export {{ {", ".join(NAMES)} }} from "three";
export {{ TrackballControls }} from "three/examples/jsm/controls/TrackballControls.js";
"""
HEADER = f"/* three.js {VERSIONS['three']}, threejs.org, MIT licence in three.LICENSE.txt; built by scripts/build_three.py */"


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        (work / "package.json").write_text('{"private": true}')
        (work / "entry.js").write_text(ENTRY)
        packages = [f"{package}@{version}" for package, version in VERSIONS.items()]
        run("npm", "install", "--no-audit", "--no-fund", "--ignore-scripts", *packages, folder=work)
        options = ["--bundle", "--minify", "--format=iife", "--global-name=THREE", "--target=es2020", "--charset=ascii"]
        options += ["--legal-comments=inline", f"--banner:js={HEADER}", "--outfile=three.min.js", "--log-level=warning"]
        run(str(work / "node_modules" / ".bin" / "esbuild"), "entry.js", *options, folder=work)
        text = (work / "three.min.js").read_text(encoding="ascii")
        # it stands in a script element, which these would end
        text = text.replace("</script", "<\\/script").replace("<!--", "<\\!--")
        (TARGET / "three.min.js").write_text(text, encoding="ascii")
        shutil.copy(work / "node_modules" / "three" / "LICENSE", TARGET / "three.LICENSE.txt")
    print(f"{TARGET / 'three.min.js'}: {len(text)} bytes")


def run(*command: str, folder: Path) -> None:
    subprocess.run(command, cwd=folder, check=True)


if __name__ == "__main__":
    main()
