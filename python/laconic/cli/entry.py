"""Where the command begins: Ctrl-C while Python still reads modules ends it by one line, too.

Nothing else is imported here before that is arranged; `guard` of laconic.cli.streams then takes the signals over.
"""

import os
import signal
from types import FrameType

STATUS_OF_CTRL_C = 130


def leave(number: int, frame: FrameType | None) -> None:
    """Ends the process at once: nothing has begun that must be brought to an end, and an exception would be lost in
    modules that catch whatever happens while they are read."""
    os.write(2, b"laconic: stopped by the user\n")
    os._exit(STATUS_OF_CTRL_C)


def main() -> None:
    """The command `laconic`."""
    signal.signal(signal.SIGINT, leave)  # also in a shell's background job, which begins with the signal ignored
    from laconic.cli.main import main as run_command

    run_command()
