"""The suite where users run it: other Pythons, oldest and newest libraries, nothing optional.

``nox -s lowest`` runs one of them; ``make release-check`` those that a release needs. The
environments are made by uv.
"""

from pathlib import Path

import nox

nox.needs_version = ">=2025.2.9"
nox.options.default_venv_backend = "uv"
nox.options.sessions = ["lowest", "plain", "wheel"]

PYTHONS = ("3.11", "3.12", "3.13")
TOOLS = ("pytest>=8.4", "pytest-xdist>=3.6", "hypothesis>=6.100")
"""What the tests cannot do without."""
PYTEST = (
    "-m",
    "pytest",
    "-q",
    "-c",
    "pyproject.toml",
    "--rootdir",
    "tests",
    "-p",
    "no:cacheprovider",
)
SPREAD = ("-n", "2", "--dist", "loadfile")
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "SPHEREMESH_CACHE": "off"}


def run_tests(session: nox.Session) -> None:
    """The suite, or the files that are named behind ``--``."""
    session.run("python", *PYTEST, *SPREAD, *(session.posargs or ("tests",)), env=ONE_THREAD)


@nox.session(python=PYTHONS)
def tests(session: nox.Session) -> None:
    """The newest of everything."""
    session.install("-e", ".", "--group", "dev")
    run_tests(session)


@nox.session(python=PYTHONS[0])
def lowest(session: nox.Session) -> None:
    """The oldest libraries that pyproject.toml allows, the extras among them."""
    bounds = Path(session.create_tmp()) / "lowest.txt"
    session.run(
        "uv", "pip", "compile", "-q", "--resolution", "lowest-direct", "--all-extras",
        "--python-version", PYTHONS[0], "-o", str(bounds), "pyproject.toml", external=True,
    )  # fmt: skip
    extras = "cluster,drawings,excel,formats,parquet"
    session.install("-c", str(bounds), "-e", f".[{extras}]", *TOOLS)
    run_tests(session)


@nox.session(python=PYTHONS[-1])
def plain(session: nox.Session) -> None:
    """Without any optional library: what needs one says so or is skipped."""
    session.install("-e", ".", *TOOLS)
    run_tests(session)


@nox.session(python=PYTHONS[0])
def wheel(session: nox.Session) -> None:
    """What is uploaded: built, installed alone, run from an empty folder, tested."""
    out, empty = Path(session.create_tmp()) / "dist", Path(session.create_tmp()) / "empty"
    for folder in (out, empty):
        folder.mkdir(exist_ok=True)
    session.run("uv", "build", "-q", "--clear", "-o", str(out), external=True)
    (built,) = out.glob("*.whl")
    (source,) = out.glob("*.tar.gz")
    session.install(str(built), *TOOLS)
    with session.chdir(empty):
        session.run("spheremesh", "panel", "-o", "roof", "--moulds", "8", env=ONE_THREAD)
    session.run(
        "uv", "build", "-q", "--wheel", "-o", str(out / "again"), str(source), external=True
    )
    run_tests(session)
