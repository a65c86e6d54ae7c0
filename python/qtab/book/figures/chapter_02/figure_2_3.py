"""Figure 2.3: optimistic initial values."""

from qtab.book.testbed import GREEDY, BanditSetting, TestbedExperiment

_STEP = {"learning_rate": 0.1, "learning_rate_schedule": "constant"}

EXPERIMENT = TestbedExperiment(
    name="figure-2.3",
    title="optimistic initial values on the 10-armed testbed",
    book="α = 0.1; initial values of 5 and a greedy policy, or of 0 and ε = 0.1; 2,000 runs of 1,000 steps",
    unspecified="ties (broken at random here)",
    settings=(
        BanditSetting(
            "optimistic, greedy: Q1 = 5, ε = 0", {**GREEDY, **_STEP, "initial_q": 5.0}, method="optimistic greedy"
        ),
        BanditSetting("realistic, ε-greedy: Q1 = 0, ε = 0.1", {**GREEDY, **_STEP, "epsilon": 0.1}, method="ε-greedy"),
    ),
    measures=("optimal",),
    y_label="% optimal action",
    y_range=(0, 100),
    table_x=(1, 10, 11, 12, 50, 100, 200, 500, 1000),
)
