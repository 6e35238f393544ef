"""Reports: plots by plotly.js, one HTML page without anything from outside, CSV of every plotted series.

:func:`dummydesign.report.page.write_report` is what every command calls; nothing is computed here.
"""
