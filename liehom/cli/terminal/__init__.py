"""Help pages, messages, words completed by the shell, and progress: the command line besides questions and answers.

`help` writes help at the width of the terminal, with examples, and reports wrong arguments. `completion` has the words
that shells complete and the scripts that make them ask. `steps` shows the step that a long command is at. All of it is
described in docs/command-line.md.
"""
