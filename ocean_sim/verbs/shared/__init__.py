"""Options, messages and progress shared by the commands."""
