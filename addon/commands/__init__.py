"""The subcommands of `plausible`: arguments in, printed results out; the work itself is done in the other rooms."""
