"""The subcommands of `plausible`: they parse arguments and print results; the other packages compute them."""
