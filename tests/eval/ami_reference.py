# SPDX-License-Identifier: BSD-3-Clause
"""Reads pairs of lines, label and truth per cell; prints scikit-learn's AMI and NMI (max) of each pair."""
import sys

from sklearn.metrics import adjusted_mutual_info_score, normalized_mutual_info_score

lines = [line.split() for line in sys.stdin if line.strip()]
for label, truth in zip(lines[::2], lines[1::2]):
    print(
        repr(float(adjusted_mutual_info_score(truth, label, average_method="max"))),
        repr(float(normalized_mutual_info_score(truth, label, average_method="max"))),
    )
