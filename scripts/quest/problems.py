"""What can end a run early, with the exit codes of the clothbench command."""


class Problem(Exception):
    """Reported to the user as it stands."""

    code = 1


class BadInput(Problem):
    code = 2


class NoDevice(Problem):
    code = 3


class Gone(NoDevice):
    """The headset was there and answers no more: unplugged, asleep, rebooting."""
