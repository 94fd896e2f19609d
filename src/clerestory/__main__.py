"""The command line as `python -m clerestory`."""

from clerestory.cli.program import main

if __name__ == "__main__":
    main()
