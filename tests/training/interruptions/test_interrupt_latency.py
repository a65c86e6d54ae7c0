"""Ctrl-C is heard within 0.2 s of CPU time, whatever the work is: updates, planning, traces, sweeps of a table."""

import json

import pytest

from support.processes.interrupts import in_a_process
from support.processes.posix import posix_only

WORK = {
    "Q-learning": "qtab.train('MountainCar-v0', episodes=10**8)",
    "planning": "qtab.train('CliffWalking-v1', algorithm='dyna_q', planning_steps=10**5, episodes=10**6)",
    "one step": "qtab.train('CliffWalking-v1', algorithm='dyna_q_plus', planning_steps=10**6, episodes=10)",
    "n-step": "qtab.train('MountainCar-v0', algorithm='n_step_sarsa', n_steps=10**6, max_episode_steps=3 * 10**5, "
    "episodes=100, env_kwargs={'goal_velocity': 1.0})",
    "traces": "qtab.train('MountainCar-v0', algorithm='sarsa_lambda', trace_decay=1.0, discount=1.0, tilings=32, "
    "tiles=100, discretizer='tiles', learning_rate=0.01, max_episode_steps=10**9, "
    "env_kwargs={'goal_velocity': 1.0})",
    "many runs": "qtab.train_many('MountainCar-v0', 10**5, threads=2, episodes=1000)",
    "many runs that plan": "qtab.train_many('CliffWalking-v1', 100, threads=2, algorithm='dyna_q', "
    "planning_steps=10**6, episodes=10**4)",
    "value iteration": "qtab.optimum(corridor, method='value_iteration', discount=0.999999)",
    "backward induction": "qtab.optimum(corridor, method='finite_horizon', max_episode_steps=10**9)",
    "Python steps": "qtab.train('CartPole-v1', backend='gymnasium', algorithm='sarsa_lambda', discretizer='tiles', "
    "tilings=32, tiles=12, episodes=10**6)",
    "verify": "qtab.verify(qtab.train('MountainCar-v0', episodes=2000))",
    "evaluate": "qtab.evaluate(qtab.train('MountainCar-v0', episodes=1), episodes=10**7)",
}
SETUP = """
states = 3000
P = {s: {a: [(0.5, max(s - 1, 0), -1.0, False), (0.5, (s * 7 + a + 1) % states, -1.0, s + 1 == states)]
         for a in range(2)} for s in range(states)}
corridor = qtab.TabularEnv(P, np.full(states, 1 / states))

def interrupt():
    global sent
    work_for(0.1)
    sent = time.process_time()
    ctrl_c()

def once(work):
    threading.Thread(target=interrupt, daemon=True).start()
    try:
        work()
    except KeyboardInterrupt:
        return time.process_time() - sent
    raise AssertionError("the work ended before the signal")

def latency(work):
    # On a busy machine, the thread that hears the signal may wait for a core while others work. Work that is not asked
    # to stop often enough is late every time.
    fastest = once(work)
    for _ in range(4):
        if fastest > 0.2:
            fastest = min(fastest, once(work))
    return fastest
"""


@posix_only
@pytest.mark.slow
def test_ctrl_c_takes_effect_within_a_fifth_of_a_second_of_cpu_time():
    calls = ", ".join(f"{name!r}: lambda: {call}" for name, call in WORK.items())
    done = in_a_process(SETUP + f"print(json.dumps({{name: latency(work) for name, work in {{{calls}}}.items()}}))")
    latencies = json.loads(done.stdout)
    assert latencies.keys() == WORK.keys()
    assert {name: seconds for name, seconds in latencies.items() if seconds > 0.2} == {}
