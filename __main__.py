"""`python -m spheremesh` and the `spheremesh` command."""

from .interfaces.cli import main

__all__ = ["main"]

if __name__ == "__main__":
    main()
