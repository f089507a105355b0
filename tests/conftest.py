import os

# No test finds what another one, or a run of the user, has kept.
os.environ["SPHEREMESH_CACHE"] = "off"
