"""`python -m laconic` is the command `laconic`."""

from laconic.cli.entry import main

if __name__ == "__main__":
    main()
