"""The same examples on every run, so that a failure is the change's and not the draw's.

HYPOTHESIS_PROFILE=search looks further.
"""

import os

from hypothesis import settings

settings.register_profile("steady", derandomize=True)
settings.register_profile("search", derandomize=False)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))
