"""What precedes the first episode: the environment is found, all settings are filled in, and the memory is computed."""
