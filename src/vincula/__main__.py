"""`python -m vincula`: the command line."""

from vincula.cli.main import main

main()
