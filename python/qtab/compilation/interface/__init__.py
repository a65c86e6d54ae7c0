"""The struct of ``qtab_env.h``, its capsule, and compiled environments that are called through it."""
