"""The texts that explain the mistakes that the grader recognises: what is wrong, and how to fix it."""

from collections.abc import Mapping

PAIRS_AT_ONCE = (
    "planning draws from all pairs of a state and an action at once. Draw a state first, and then one of the actions "
    "tried in it"
)
"""The explanation of two mistakes, which differ in the order of the pairs."""
MISTAKES: Mapping[str, str] = {
    # the policy
    "epsilon_inverted": (
        "epsilon is inverted: the function is greedy with probability epsilon. Explore with probability epsilon: "
        "take a greedy action if rng.random() < 1 - epsilon"
    ),
    "epsilon_inverted_other_draws": (
        "epsilon is inverted: the function explores with probability 1 - epsilon. Take a greedy action if "
        "rng.random() < 1 - epsilon, and a random one otherwise"
    ),
    "explores_below_epsilon": (
        "the probabilities are right, but the draws differ: the function explores if rng.random() < epsilon. Here the "
        "action is greedy if rng.random() < 1 - epsilon, and random otherwise"
    ),
    "draws_action_first": (
        "the random numbers are drawn in another order: the function draws the random action before it draws "
        "rng.random(), or also when it is not used. Draw rng.random() first, and rng.integers(n) only to explore"
    ),
    "explores_without_greedy": (
        "the function explores only among the other actions. A random action is drawn from all actions, the greedy one "
        "included"
    ),
    "random_ties": "ties are broken at random. Take the first of the actions with the largest value, as np.argmax does",
    "last_tie": "of several actions with the largest value the last is taken. Take the first, as np.argmax does",
    # the steps
    "state_kept": (
        "the state never changes within an episode: after each step, the next state becomes the state "
        "(state = next_state)"
    ),
    "no_last_update": (
        "the last step of an episode is not updated: the loop ends before the update. Update first, and then leave the "
        "loop if terminated or truncated"
    ),
    # the update
    "truncation": (
        "truncation is treated as termination: the value of the next state is left out when the time limit ends an "
        "episode. Only a terminal state has the value 0: leave the next value out if terminated, not if truncated"
    ),
    "terminal_value": (
        "the target includes the value of a terminal state. Nothing follows a terminal state: if terminated, the "
        "target is the reward alone"
    ),
    "swapped_rates": "the learning rate and the discount are swapped",
    "no_discount": "the discount is missing: the next value in the target is multiplied by it",
    "no_old_value": (
        "the old value is missing in the error: a value moves by learning_rate * (target - value), not by "
        "learning_rate * target"
    ),
    "rounding": (
        "the formula is right, but rounded in another order: (1 - learning_rate) * value + learning_rate * target. To "
        "equal the reference to the last bit, write value += learning_rate * (target - value)"
    ),
    "old_action": (
        "the target uses the old action in the next state, q[next_state, action]. Sarsa uses the next action, "
        "q[next_state, next_action]"
    ),
    "max_in_sarsa": "the target uses the largest value of the next state, which is Q-learning. Sarsa uses that of A'",
    "q_learning": (
        "this is Q-learning: the target uses the largest value of the next state, and the next action is chosen after "
        "the update. Sarsa chooses the next action first, uses its value in the target, and then takes it"
    ),
    "value_of_old_state": "the target uses a value of the old state, q[state, ...]. It needs one of the next state",
    "draws_again": (
        "the next action is drawn twice: once for the target and once more to act. Sarsa takes the action that is in "
        "its target"
    ),
    "draws_at_end": (
        "the updates are right, but the function draws an action in a terminal state, where none is taken. Draw none "
        "there, so that the random numbers stay the same"
    ),
    "max_of_old_state": (
        "the target uses the largest value of the old state, q[state].max(). It needs q[next_state].max()"
    ),
    "max_of_table": "the target uses the largest value of the whole table, q.max(). It needs q[next_state].max()",
    "argmax": "the target uses np.argmax, which is the number of an action. It needs the largest value itself, np.max",
    "sampled_action": (
        "the target uses the value of a sampled next action, as Sarsa does. Q-learning uses the largest value"
    ),
    "early_choice": (
        "the next action is chosen before the update. Update first, and choose the next action with the new values"
    ),
    "old_policy": "the probabilities are those of the old state. They must be those of the next state",
    "uniform_policy": "all actions have the same probability in the sum. Use those of the epsilon-greedy policy",
    "greedy_share": (
        "the greedy action has the probability 1 - epsilon, and the others share epsilon. Exploring draws from all "
        "actions: the greedy one has 1 - epsilon + epsilon / n, and every other one epsilon / n"
    ),
    "greedy_policy": "the target uses the largest value, which is Q-learning. Expected Sarsa weighs all values",
    "one_step_more": "the return is over n + 1 steps: an update waits for one step too many",
    "discount_once": (
        "the value after the last reward is discounted once. In a return of n rewards its factor is discount ** n"
    ),
    "end_not_flushed": "the last steps of an episode are not updated. After its end, update all steps that still wait",
    "no_value_at_time_out": (
        "the value of the last state is left out when the time limit ends an episode, as in the book's box, whose "
        "episodes have no time limit. Leave it out only if terminated"
    ),
    # Monte Carlo
    "every_visit": (
        "every visit is updated. First-visit Monte Carlo updates a state and action only for its first visit in an "
        "episode"
    ),
    "last_visit": (
        "the last visit of a state and action in an episode is updated instead of the first. Going backwards, the "
        "visit that you meet first is the last one: look for the pair among the earlier steps, pairs[:t]"
    ),
    "late_reward": "the return leaves out the reward of its own step: G = R + discount * G comes before the update",
    # Dyna-Q
    "no_planning": "the function does not plan, or the plans change nothing",
    "plans_over_pairs": PAIRS_AT_ONCE,
    "plans_over_pairs_by_state": PAIRS_AT_ONCE,
    "model_after_planning": "the step is stored only after planning. Store the step first, and plan afterwards",
    # traces
    "replacing_traces": "the traces are replaced by 1. Accumulating traces add 1",
    "traces_kept": "the traces are kept from one episode to the next. They are 0 at the start of each",
    "early_decay": "the traces decay between adding 1 and the update. Let them decay after the update",
    "decay_without_discount": "the traces decay by trace_decay alone. They decay by discount * trace_decay",
    "not_divided": "the step size is not divided by the number of active features, len(rows)",
    # bandits
    "count_late": "the count grows after the update. The n-th reward has the step size 1 / n, so count it first",
    "all_counts": "the step size is 1 over the number of all steps. Divide by the count of the action alone",
    "first_action": "the wrong action is updated: always the first one",
    # dynamic programming
    "in_place": "the sweep uses new values of earlier states. In this exercise every state uses the old values",
    "two_arrays": "the sweep uses only old values. In this exercise states use the new values of earlier states",
    "no_probabilities": "the probabilities of the next states are missing in the sum",
    "uniform_actions": "all actions have the same weight. Weigh them by policy[state, action]",
    "discounted_reward": "the reward is discounted. Only the value of the next state is",
    "one_sweep_more": (
        "there is one sweep too many: stop after the first one in which no value changes by more than tolerance"
    ),
    "signed_change": (
        "a value that falls does not count as changed, so that the sweeps end too soon. Take the largest absolute "
        "change, abs(new - old)"
    ),
    "average_not_max": "a value is the mean of the action values. It must be the largest",
}
"""What is wrong and how to fix it, by the key of the mistake."""
