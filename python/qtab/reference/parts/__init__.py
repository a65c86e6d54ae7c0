"""What all learners share: the task with its observations and actions, policies, schedules, random numbers."""
