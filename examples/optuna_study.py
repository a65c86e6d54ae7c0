"""Tunes Sarsa(λ) with Optuna. Each setting that Optuna proposes is trained with several seeds in one `qtab.sweep`."""

import optuna

import qtab

SEEDS = 20


def search(batches: int = 10, size: int = 4, episodes: int = 300) -> optuna.Study:
    """Maximizes the mean return of the last 100 episodes of MountainCar-v0.

    Args:
        batches: The number of sweeps.
        size: The number of settings in each sweep.
        episodes: The number of training episodes of each run.

    Returns:
        The study, with one trial per setting.
    """
    study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=0))
    for _ in range(batches):
        trials = [study.ask() for _ in range(size)]
        settings = [
            {
                "learning_rate": trial.suggest_float("learning_rate", 0.05, 1.5, log=True),
                "trace_decay": trial.suggest_float("trace_decay", 0.0, 1.0),
            }
            for trial in trials
        ]
        results = qtab.sweep(
            "MountainCar-v0",
            settings,
            seeds=SEEDS,
            preset="solved",
            learning_rate_schedule="linear",
            episodes=episodes,
        )
        for index, trial in enumerate(trials):
            study.tell(trial, float(results.values("final_return", index).mean()))
    return study


if __name__ == "__main__":
    best = search().best_trial
    print(f"{best.value:.1f} with {best.params}")
