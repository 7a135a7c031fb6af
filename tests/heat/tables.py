"""What a sensor's table says, the other way round."""

from passo.config.sensor_tables import Table, share_at


def celsius_at(table: Table, share: float) -> float:
    """The inverse of `share_at`."""
    return share_at(tuple(sorted((row[1], row[0]) for row in table)), share)
