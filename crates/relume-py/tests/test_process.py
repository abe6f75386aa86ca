"""How a call behaves in the process around it: Ctrl-C, other threads, forks."""

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from shapes import grid

import relume

# A bake of some minutes, made of tiles of some seconds.
LONG = dict(samples=1 << 20, bounces=8)
# How late an exception may come: the tenth of a second that is promised, and what a busy machine adds.
SOON = 1.0

INTERRUPTED = """
import os, signal, sys, threading, time
import relume
from shapes import grid

sent = []
def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

threading.Timer(0.5, interrupt).start()
try:
    relume.bake(*grid(40), samples=1 << 20, bounces=8)
except KeyboardInterrupt:
    print(time.monotonic() - sent[0], flush=True)
# What was left to stop by itself is not in the way.
relume.bake(*grid(3), samples=16, threads=1)
"""


def bake_of(seconds):
    """Arguments of a bake that takes about so long here."""
    samples = 1 << 12
    while True:
        start = time.monotonic()
        relume.bake(*grid(20), samples=samples)
        if time.monotonic() - start > seconds or samples == 1 << 22:
            return dict(zip(("vertices", "faces"), grid(20)), samples=samples)
        samples *= 2


def interruptible():
    """Tests that run in the background of a script inherit that Ctrl-C is ignored, and a Python started so does not hear it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@contextlib.contextmanager
def python(code):
    """A Python that runs `code`, ended at the latest when the test is."""
    folders = os.pathsep.join([os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")])
    with subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": folders},
        preexec_fn=interruptible if os.name == "posix" else None,
    ) as child:
        try:
            yield child
        finally:
            child.kill()


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("more", ["", ", order=3, transfer='glossy', transfer_order=4, brdf=relume.Phong()"], ids=["diffuse", "glossy"])
def test_ctrl_c_raises_keyboard_interrupt_at_once(more):
    with python(INTERRUPTED.replace(", bounces=8", ", bounces=8" + more)) as child:
        out, err = child.communicate(timeout=60)
    assert not err, err
    assert float(out) < SOON


BOUNCES = """
import dataclasses, os, signal, threading, time
import relume
from shapes import grid

sent = []
def interrupt():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

few = relume.bake(*grid(40), samples=16, order=2, transfer="glossy", transfer_order=4)
many = dataclasses.replace(few, samples=4096)
sky = relume.light("sky:30,3", order=2)
threading.Timer(0.5, interrupt).start()
try:
    relume.shade(many, sky, eye=(1, 3, 2), bounces=64)
except KeyboardInterrupt:
    print(time.monotonic() - sent[0], flush=True)
# The threads that cast rays stop, too.
time.sleep(0.2)
start = time.process_time()
time.sleep(0.5)
print(time.process_time() - start, flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_ctrl_c_ends_bounces_of_glossy_surfaces():
    with python(BOUNCES) as child:
        out, err = child.communicate(timeout=60)
    assert not err, err
    late, busy = map(float, out.split())
    # Of half a second on each core.
    assert late < SOON and busy < 0.05


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_ctrl_c_ends_a_program_that_does_not_catch_it():
    with python(f"import relume; from shapes import grid; print('go', flush=True); relume.bake(*grid(40), **{LONG})") as child:
        assert child.stdout.readline() == "go\n"
        time.sleep(0.3)
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        _, err = child.communicate(timeout=60)
        assert time.monotonic() - start < SOON
    assert err.rstrip().endswith("KeyboardInterrupt")
    # Python ends itself by the signal it was interrupted by.
    assert child.returncode == -signal.SIGINT


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_other_signals_do_not_disturb_a_bake():
    bake, heard = bake_of(0.5), []
    before = signal.signal(signal.SIGALRM, lambda *_: heard.append(time.monotonic()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1, 0.1)
        start = time.monotonic()
        disturbed = relume.bake(**bake)
        end = time.monotonic()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    # Handlers run while it bakes, not after.
    assert [when for when in heard if start < when < end - 0.05]
    np.testing.assert_array_equal(disturbed, relume.bake(**bake))


def test_other_threads_go_on_while_one_bakes():
    bake, ticks, stop = bake_of(0.5), [], threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        start = time.monotonic()
        relume.bake(**bake)
        end = time.monotonic()
    finally:
        stop.set()
        thread.join()
    # Held, the lock would leave ticks at the ends alone.
    middle = [when for when in ticks if start + 0.2 * (end - start) < when < end - 0.2 * (end - start)]
    assert len(middle) >= 5, (len(ticks), end - start)


def test_other_threads_go_on_and_move_lights_while_near_light_is_found():
    emitters = relume.Emitters([relume.Emitter(relume.Sphere(0.1), 1), relume.Emitter(relume.Quad(1, 1), 1)])
    count, points = 1 << 10, None
    while True:
        points = np.random.default_rng(2).uniform(1, 2, size=(count, 3))
        start = time.monotonic()
        expected = emitters.light_at(points, 10)
        if time.monotonic() - start > 0.5 or count == 1 << 22:
            break
        count *= 2
    moves, stop = [], threading.Event()

    def move():
        while not stop.wait(0.005):
            emitters.set_pose(0, np.eye(4))
            moves.append(time.monotonic())

    thread = threading.Thread(target=move)
    thread.start()
    try:
        start = time.monotonic()
        found = emitters.light_at(points, 10)
        end = time.monotonic()
    finally:
        stop.set()
        thread.join()
    middle = [when for when in moves if start + 0.2 * (end - start) < when < end - 0.2 * (end - start)]
    assert len(middle) >= 5, (len(middle), end - start)
    # To where they stood.
    np.testing.assert_array_equal(found, expected)


def test_bakes_in_several_threads_do_not_disturb_each_other():
    expected, results = relume.bake(*grid(9), samples=256).tobytes(), []
    threads = [threading.Thread(target=lambda: results.append(relume.bake(*grid(9), samples=256).tobytes())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 4


def work():
    vertices, faces = grid(3)
    transfer = relume.bake(vertices, faces, samples=16)
    lamp = relume.Emitters([relume.Emitter(relume.Sphere(2), 1, two_sided=True)])
    return relume.shade(transfer, lamp.light_at(vertices) + relume.light("sky:30,3")).tobytes()


def work_in_a_child(queue):
    queue.put(work())


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="needs fork")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_process_works_after_its_parent_has():
    expected = work()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=work_in_a_child, args=(queue,))
    child.start()
    try:
        assert queue.get(timeout=60) == expected
    finally:
        child.kill()
        child.join()


TOO_LARGE = """
import resource
import numpy as np, relume
vertices = np.zeros((100_000, 3), np.float32)
vertices[1, 0] = vertices[2, 2] = 1
# Three copies of 100,000 rows of 3 × 1024 numbers are 3.7 GB.
resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
try:
    relume.bake(vertices, [[0, 2, 1]], order=32, bounces=1, samples=1, threads=1)
except MemoryError as error:
    print(error)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs a limit on address space")
def test_a_result_larger_than_memory_is_a_memory_error():
    with python(TOO_LARGE) as child:
        out, err = child.communicate(timeout=60)
    assert (out, err) == ("the bake needs 5329600000 bytes: lower order, or bake parts of the mesh\n", "")
