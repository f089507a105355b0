"""The date in files, which is not the clock's: the same job gives the same bytes."""

import os
from datetime import UTC, datetime

from ..kernel.errors import InputError


def file_date() -> datetime:
    """The date of a file: `source_date`, or the first second of 1970, in UTC."""
    return source_date() or datetime(1970, 1, 1, tzinfo=UTC)


def source_date() -> datetime | None:
    """What the environment variable SOURCE_DATE_EPOCH says, in seconds since 1970.

    Returns
    -------
    datetime or None
        In UTC; None where it is not set.

    Raises
    ------
    InputError
        If it is no such number.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not epoch:
        return None
    try:
        return datetime.fromtimestamp(int(epoch), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise InputError(
            f"SOURCE_DATE_EPOCH is {epoch!r}: set it to seconds since 1970, or leave it out"
        ) from error
