"""Figure 2.4: upper-confidence-bound action selection."""

from qtab.book.testbed import GREEDY, SAMPLE_AVERAGES, BanditSetting, TestbedExperiment

EXPERIMENT = TestbedExperiment(
    name="figure-2.4",
    title="UCB action selection on the 10-armed testbed",
    book="c = 2 against ε = 0.1, sample averages; 2,000 runs of 1,000 steps",
    unspecified="ties (broken at random here); t in ln t (the number of the step here, from 1)",
    settings=(
        BanditSetting(
            "UCB, c = 2",
            {**SAMPLE_AVERAGES, "initial_q": 0.0, "exploration": "ucb", "confidence": 2.0, "ties": "random"},
            method="UCB",
        ),
        BanditSetting("ε-greedy, ε = 0.1", {**GREEDY, **SAMPLE_AVERAGES, "epsilon": 0.1}, method="ε-greedy"),
    ),
    measures=("reward",),
    y_label="average reward",
    table_x=(1, 10, 11, 12, 50, 100, 200, 500, 1000),
)
