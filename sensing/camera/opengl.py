"""Which OpenGL library renders without a display, found out by trying.

A process can use one library alone, and one that is broken may end the process that tries it: so each is tried in a
process of its own. `MUJOCO_GL` says which to use; where it says nothing, OSMesa is tried first (without a graphics card
it renders as fast as EGL or faster), then EGL. What was found is kept in `MUJOCO_GL`, so that worker processes use the
same.

MuJoCo itself reads `MUJOCO_GL` when it is imported, and fails for a wrong name or a library that is missing, whether or
not anything is rendered. So a command sets it aside first (`set_aside`), and only what renders fails.
"""

from __future__ import annotations

import atexit
import importlib
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from flocking.errors import InputError

LIBRARIES = ("osmesa", "egl")
NEEDED = {"osmesa": "libosmesa6", "egl": "libegl1 libgl1-mesa-dri"}
"""Debian's packages."""
VARIABLE = "MUJOCO_GL"
ASIDE = "CREATE_HERD_MUJOCO_GL"
"""Where what the user's `MUJOCO_GL` says is kept, for this process and those that it starts."""
LIMIT_S = 120.0
"""Wall time for one trial of a library: it takes a second."""
LONGEST = 200
"""Letters of what a library says against it that are told."""


def set_aside() -> None:
    """Takes `MUJOCO_GL` out of the environment, before MuJoCo is imported, and keeps what it says."""
    given = os.environ.pop(VARIABLE, None)
    if given is not None:
        os.environ[ASIDE] = given


def asked_for() -> str:
    """What `MUJOCO_GL` says, set aside or not; empty where it says nothing."""
    return (os.environ.get(VARIABLE) or os.environ.get(ASIDE, "")).lower().strip()


def library() -> str:
    """The library that renders: `osmesa` or `egl`. Raises `InputError` with the packages that are missing."""
    named = asked_for()
    if named and named not in LIBRARIES:
        raise InputError(f"{VARIABLE} = {named!r} renders nothing off-screen; expected {' or '.join(LIBRARIES)}")
    if (named, os.getpid()) == _tried:
        return named
    faults = []
    for each in (named,) if named else LIBRARIES:
        fault = "" if os.environ.get(_FOUND) == each else _fault(each)
        if not fault:
            _keep(each)
            return each
        faults.append(f"{each} ({fault})")
    packages = " or ".join(f"apt-get install {NEEDED[each]}" for each in ((named,) if named else LIBRARIES))
    raise InputError(f"images need OpenGL to render off-screen, and none did: {', '.join(faults)}; expected {packages}")


_SMALL = 16
"""Pixels of the context's own buffer, which nothing is drawn into."""
_FOUND = "CREATE_HERD_GL"
"""Tells the processes that this one starts which library was tried and renders."""
_tried: tuple[str, int] = ("", -1)


def _keep(each: str) -> None:
    global _tried
    os.environ[VARIABLE] = os.environ[_FOUND] = each
    _tried = (each, os.getpid())


@cache
def context() -> Any:
    """The OpenGL context of this process, of the library that renders. Raises `InputError` where there is none.

    All drawing is done in one, so that what is drawn with can be freed whichever was used last. Images are drawn into
    buffers of their own size.
    """
    its = library()
    os.environ.setdefault("LP_NUM_THREADS", "0")  # workers run side by side
    try:
        made = importlib.import_module(f"mujoco.{its}").GLContext(_SMALL, _SMALL)
        made.make_current()
    except Exception as error:  # what a broken library raises is its own
        raise InputError(f"{its} does not render: {_told(str(error))}; expected {NEEDED[its]}") from error
    atexit.register(_leave, made)
    return made


def _leave(made: Any) -> None:
    """Frees a context before its library is left; its own destructor comes after that."""
    made.free()
    made.free = _nothing


def _nothing() -> None:
    """In place of what has been done."""


def _fault(each: str) -> str:
    """What a library says against rendering in a process of its own; empty if it renders."""
    folder = str(Path(__file__).parents[2])
    paths = [folder, *filter(None, [os.environ.get("PYTHONPATH", "")])]
    own = {**os.environ, VARIABLE: each, "PYTHONPATH": os.pathsep.join(paths)}
    own.pop("PYOPENGL_PLATFORM", None)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "sensing.camera.opengl", each], env=own, capture_output=True, text=True,
            timeout=LIMIT_S, stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"did not return within {LIMIT_S:g} s"
    if done.returncode == 0 and "renders" in done.stdout:
        return ""
    return _told(done.stdout or done.stderr) or f"ended with code {done.returncode}"


def _told(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:LONGEST] if lines else ""


def _try(each: str) -> None:
    """Renders a red box. Runs in the process of its own."""
    import mujoco
    import numpy as np

    context_of = importlib.import_module(f"mujoco.{each}").GLContext
    xml = "<mujoco><worldbody><light pos='0 0 3'/><geom type='box' size='1 1 1' rgba='1 0 0 1'/></worldbody></mujoco>"
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    made = context_of(64, 64)
    made.make_current()
    scene, rect = mujoco.MjvScene(model, 10), mujoco.MjrRect(0, 0, 64, 64)
    drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, drawing)
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), 7, scene)
    mujoco.mjr_render(rect, scene, drawing)
    pixels = np.empty((64, 64, 3), np.uint8)
    mujoco.mjr_readPixels(pixels, None, rect, drawing)
    if pixels.min() == pixels.max():
        raise RuntimeError("rendered nothing")
    print("renders", flush=True)


if __name__ == "__main__" and len(sys.argv) == 1:  # what renders here, for the set-up
    try:
        print(library())
    except InputError as error:
        sys.exit(f"create-herd: {error}")
elif __name__ == "__main__":
    try:
        _try(sys.argv[1])
    except BaseException as error:
        print(f"{type(error).__name__}: {' '.join(str(error).split())}", flush=True)
        os._exit(1)
    os._exit(0)  # libraries that fail when they are left have done their work
