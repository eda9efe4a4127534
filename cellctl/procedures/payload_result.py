"""Where the payload's result was first kept; it is pure and lives in ``cellctl.force`` now."""

from cellctl.force.payload_result import (
    PayloadResult,
    compensation_from_document,
    evaluate_payload,
    payload_document,
)

__all__ = ["PayloadResult", "compensation_from_document", "evaluate_payload", "payload_document"]
