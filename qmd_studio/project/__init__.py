"""The open document, its commands and its history."""
