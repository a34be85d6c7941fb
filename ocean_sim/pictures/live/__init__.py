"""The preview in a GGUI window: state, eye and arrays."""
