"""Runs Blender in a separate process, with an empty user profile."""
import json
import os
import subprocess
import sys

# Blender 4.2 crashes and 4.5 hangs when a process ends with registered Python classes. So every script ends in `leave`,
# and `fail` prints an error and fails the test.
_FRAME = """
import json, os, sys, traceback

def leave(code):
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)

def fail(*error):
    traceback.print_exception(*error)
    leave(1)

sys.excepthook = fail
import bpy

def install(path):
    assert bpy.ops.extensions.package_install_files(
        filepath=path, repo="user_default", enable_on_install=True) == {"FINISHED"}
    package = "bl_ext.user_default.plausible_brdf"
    assert package in bpy.context.preferences.addons, "the extension is not enabled"
    return sys.modules[package + ".addon"]

def render(to):
    bpy.context.scene.render.filepath = to
    bpy.ops.render.render(write_still=True)
    # Color management is off, and so the file holds what Cycles computed.
    image = bpy.data.images.load(to)
    pixels = [round(value, 7) for value in image.pixels[:]]
    bpy.data.images.remove(image)
    return pixels

BODY
leave(0)
"""


def run_blender(tmp_path, body, *arguments, profile="profile", **variables):
    """Runs `body` in a separate Blender with an empty user profile; returns the JSON object it prints last, or None.

    `variables` are added to the environment. Fails where the process fails or prints a traceback.
    """
    script = tmp_path / "script.py"
    script.write_text(_FRAME.replace("BODY", body), encoding="utf-8")
    folder = tmp_path / profile
    folder.mkdir(exist_ok=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment |= {"BLENDER_USER_RESOURCES": str(folder), **variables}
    result = subprocess.run([sys.executable, str(script), *map(str, arguments)], capture_output=True, text=True,
                            env=environment, cwd=tmp_path, timeout=300)
    assert result.returncode == 0, f"exit code {result.returncode}\n{result.stdout}\n{result.stderr}"
    assert "Traceback" not in result.stdout + result.stderr, result.stdout + result.stderr
    printed = [line for line in result.stdout.splitlines() if line.startswith("{")]
    return json.loads(printed[-1]) if printed else None
