# SPDX-License-Identifier: BSD-3-Clause
"""The parts of shoal_reader.py: one file an idea, from bytes to maps."""
