"""Where numbers lie in memory: of states, observations, parameters, and the attributes of a class."""
