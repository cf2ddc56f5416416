"""What every record of a scenario shares: frozen, checked, refused in words; and the kinds of value they hold."""

from fieldline.records.record import Record, RecordError

__all__ = ["Record", "RecordError"]
