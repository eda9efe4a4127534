"""The factor of expanded uncertainties: alone, so that a report can name it without computing."""

COVERAGE_FACTOR = 2.0
"""Standard deviations in an expanded uncertainty: one of 44 values lies beyond it on the
side of the limit (JCGM 100, 6.2; JCGM 106, 8.3)."""
