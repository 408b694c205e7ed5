"""Runs the verbs as `python -m qmd_studio.cli`, where `qmd` is not installed."""

from qmd_studio.cli.main import main

raise SystemExit(main())
