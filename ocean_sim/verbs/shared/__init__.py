"""Options, messages and progress that verbs share; none of it is a kind that a scene may name."""
