"""What can end a run early, with the exit codes of the clothbench command."""


class Problem(Exception):
    """An error whose text is shown to the user."""

    code = 1


class BadInput(Problem):
    code = 2


class NoDevice(Problem):
    code = 3


class Gone(NoDevice):
    """The headset no longer answers: unplugged, asleep or rebooting."""
