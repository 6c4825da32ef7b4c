"""What users see of the command line besides results: help, messages, names completed by the shell, running steps.

`help` writes help at the width of the terminal, with examples, and reports wrong arguments; `completion` has the words
that shells complete and the scripts that make them ask; `steps` shows what a long command is doing. All of it is
described in docs/command-line.md.
"""
