"""A run, or several, as one page: self-contained HTML to read offline and on paper."""
