"""Materials of ours: the node, its sockets and program, and what becomes of them in a working life."""
