"""Design: scores, search, assessment, sweeps; does not know how a number was made.

:func:`dummydesign.design.suggest.suggest` and :func:`dummydesign.design.sweep.run.whatif` are the documented calls.
"""
