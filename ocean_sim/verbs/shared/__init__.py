"""What the modules of `verbs` share; none of it is a kind that a scene may name."""
