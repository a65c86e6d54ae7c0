"""The twelve exercises, one per file: the starter code, the model with its mistakes, and the checks.

A model is a complete learner with its loop over episodes and steps, although the loops of Sarsa, Q-learning, Expected
Sarsa and n-step Sarsa are much alike: each can be compared line by line with the solution on the page of its exercise,
and each mistake stands where a student makes it. Shared are the parts in :mod:`qtab.exercises.parts`, the transition
tables (:mod:`qtab.exercises.definitions.tables`), and the checks of learners of action values
(:mod:`qtab.exercises.definitions.control_checks`).
"""
