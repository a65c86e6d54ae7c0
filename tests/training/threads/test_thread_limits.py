"""Where the system starts no more threads, work goes on with those that there are, to the same results."""

import json
import sys

import pytest

from support.processes.interrupts import in_a_process
from support.processes.posix import posix_only

LIMIT = """
import resource, hashlib
def digest(*arrays):
    return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)).hexdigest()

def work():
    # Long enough for a thread of its own.
    run = qtab.train("MountainCar-v0", episodes=30_000, seed=0)
    runs = qtab.train_many("MountainCar-v0", 10, threads=4, episodes=20)
    best = qtab.optimum("CliffWalking-v1")
    env = gym.make_vec("qtab/Acrobot-v1", 64, threads=4)
    env.reset(seed=0)
    steps = [env.step(np.arange(64) % 2)[0] for _ in range(50)]
    return [digest(run.tables, run.episode_returns), digest(runs.episode_returns), digest(best.values), digest(*steps)]

def cannot_start():
    try:
        threading.Thread(target=int).start()
    except RuntimeError:
        return True
    return False

with_threads = work()
if os.geteuid() == 0:
    os.setuid(65534)  # nobody: the limit does not hold for root
resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))
"""


@posix_only
@pytest.mark.skipif(sys.platform != "linux", reason="the limit of threads is Linux's")
def test_without_threads_the_results_are_the_same():
    done = in_a_process(LIMIT + "print(json.dumps([cannot_start(), work() == with_threads]))")
    limited, same = json.loads(done.stdout)
    if not limited:
        pytest.skip("this system starts threads beyond RLIMIT_NPROC")
    assert same


@posix_only
@pytest.mark.skipif(sys.platform != "linux", reason="the limit of threads is Linux's")
def test_ctrl_c_is_heard_without_threads():
    done = in_a_process(
        LIMIT
        + """
def handler(number, frame):
    raise KeyboardInterrupt
signal.signal(signal.SIGVTALRM, handler)
heard = []
for call in (
    lambda: qtab.train("MountainCar-v0", episodes=10**8),
    lambda: qtab.train_many("MountainCar-v0", 10**5, threads=2, episodes=1000),
):
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.3)  # of work: training has then begun, on a busy machine, too
    try:
        call()
    except KeyboardInterrupt as interrupt:
        heard.append(interrupt.run.completed)
print(json.dumps([cannot_start(), heard]))
"""
    )
    limited, heard = json.loads(done.stdout)
    if not limited:
        pytest.skip("this system starts threads beyond RLIMIT_NPROC")
    assert heard == [False, False]
