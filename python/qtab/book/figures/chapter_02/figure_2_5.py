"""Figure 2.5: the gradient bandit algorithm with and without a baseline."""

from qtab.book.testbed import BanditSetting, TestbedExperiment

EXPERIMENT = TestbedExperiment(
    name="figure-2.5",
    title="the gradient bandit algorithm with and without a baseline",
    book="α = 0.1 and 0.4, with the average reward as the baseline or without one; true values of mean 4; 1,000 steps",
    unspecified="the number of runs (2,000 here, as elsewhere in the chapter). The baseline is the average of the "
    "previous rewards, as in equation 2.12; a footnote says that the book's figures include the current one",
    settings=tuple(
        BanditSetting(
            f"{'with' if baseline else 'without'} baseline, α = {alpha:g}",
            {"algorithm": "gradient_bandit", "learning_rate": alpha, "baseline": baseline, "initial_q": 0.0},
            method="gradient bandit" if baseline else "gradient bandit without baseline",
            dashed=alpha == 0.4,
        )
        for baseline in (True, False)
        for alpha in (0.1, 0.4)
    ),
    measures=("optimal",),
    mean=4.0,
    y_label="% optimal action",
    y_range=(0, 100),
    table_x=(1, 10, 50, 100, 200, 500, 1000),
)
