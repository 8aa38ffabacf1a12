"""Parts of scripts/quest_run.py; see README.md beside this file."""
