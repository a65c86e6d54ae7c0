"""Figure 2.2: ε-greedy action selection on the 10-armed testbed."""

from qtab.book.testbed import GREEDY, SAMPLE_AVERAGES, BanditSetting, TestbedExperiment

EXPERIMENT = TestbedExperiment(
    name="figure-2.2",
    title="ε-greedy methods on the 10-armed testbed",
    book="ε = 0, 0.01 and 0.1, sample averages, initial values of zero; true values of mean 0 and variance 1, rewards "
    "of variance 1; 2,000 runs of 1,000 steps",
    unspecified="ties (broken at random here)",
    settings=tuple(
        BanditSetting(f"ε = {epsilon:g}", {**GREEDY, **SAMPLE_AVERAGES, "epsilon": epsilon})
        for epsilon in (0.0, 0.01, 0.1)
    ),
    y_label="average reward, % optimal action",
    table_x=(1, 10, 50, 100, 200, 500, 1000),
)
