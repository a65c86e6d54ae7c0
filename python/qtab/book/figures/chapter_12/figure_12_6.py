"""Figure 12.6: TD(λ) by λ and α on the random walk of 19 states."""

from qtab.book.prediction_experiment import PredictionExperiment
from qtab.book.random_walks import TOP, by_trace_decay_and_rate

EXPERIMENT = PredictionExperiment(
    name="figure-12.6",
    title="TD(λ) by λ and α",
    book="19 states, rewards -1 and 1 at the ends, γ = 1, initial values of zero; errors at the ends of the first 10 "
    "episodes, averaged over the states, the episodes and 100 runs",
    unspecified="the values of α that are drawn",
    settings=by_trace_decay_and_rate("td_lambda"),
    runs=100,
    x_label="α",
    y_label="RMS error over the first 10 episodes",
    table_x=(0.1, 0.2, 0.4, 0.6, 0.8, 1.0),
    y_range=(0.25, TOP),
)
