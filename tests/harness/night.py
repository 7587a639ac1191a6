# SPDX-License-Identifier: MIT
"""Marks tests that run only by night, as neph_test_waits_for_the_night() of tests/neph_test.h
does."""
import os
import unittest

of_the_night = unittest.skipUnless(os.environ.get("NEPH_TEST_NIGHT"),
                                   "waits for the night: scripts/test --night")
