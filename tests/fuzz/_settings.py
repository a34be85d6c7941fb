"""How many examples hypothesis draws: few and always the same in every run of the tests, many when asked for."""

from hypothesis import HealthCheck, Phase, settings

few = settings(max_examples=25, derandomize=True, deadline=None, database=None, phases=[Phase.generate])
few = settings(few, suppress_health_check=list(HealthCheck))
many = settings(few, max_examples=700, derandomize=False, print_blob=True)
