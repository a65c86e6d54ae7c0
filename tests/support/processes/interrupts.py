"""Runs code that interrupts itself, in a separate Python process."""

import subprocess
import sys

PRELUDE = """
import json, os, signal, sys, threading, time
import _thread
import gymnasium as gym, numpy as np, qtab

signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts in the background would ignore it
main = threading.main_thread().ident

MADE = {"train_resolved": "trainer", "train_many": "results"}  # just before training begins

def training():
    frame = sys._current_frames()[main]
    while frame is not None:
        if MADE.get(frame.f_code.co_name) in frame.f_locals:
            return True
        frame = frame.f_back
    return False

def work_for(seconds):
    # Of the processor's time: on a busy machine, little may be done in a time by the clock.
    began = time.process_time()
    while time.process_time() < began + seconds:
        time.sleep(0.005)

def once_it_trains(then):
    def wait():
        while not training():
            time.sleep(0.01)
        work_for(0.1)
        then()
    threading.Thread(target=wait, daemon=True).start()

def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)

def report(run, **more):
    print(json.dumps({
        "completed": run.completed,
        "episodes": len(run.episode_returns),
        "learned": int((run.q_table != 0.0).sum()),
        "finite": bool(np.isfinite(run.q_table).all()),
        **more,
    }))

ENDLESS = dict(env_kwargs={"goal_velocity": 1.0}, max_episode_steps=10**12, initial_q=(0.0, 0.0), seed=0)
"""


def in_a_process(code, expect=0):
    done = subprocess.run([sys.executable, "-c", PRELUDE + code], capture_output=True, text=True, timeout=600)
    assert done.returncode == expect, done.stderr
    return done
