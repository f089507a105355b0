"""`python -m spheremesh` and the `spheremesh` command."""

from .interfaces.cli import main as commands
from .interfaces.console import tidy_up_on_signals

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    tidy_up_on_signals()
    commands()


if __name__ == "__main__":
    main()
