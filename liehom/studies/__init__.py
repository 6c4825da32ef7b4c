"""Uses of both halves: the systems and figures of the paper, and the atlas of pairs."""
