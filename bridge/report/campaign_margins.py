"""The margins of a campaign as a chart beside the theory."""

from bridge.runs.campaign.campaign import Found


def margins(found: Found) -> str:
    """The section; empty without margins."""
    return ""
