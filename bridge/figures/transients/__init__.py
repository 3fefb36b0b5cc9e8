"""Load change and impingement."""
