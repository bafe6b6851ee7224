#!/bin/sh
# Writes two copies of log.csv with faults that real logs have, for docs/manual/tutorial.md.
set -eu
# The torques of the first two joints are exchanged.
awk -F, -v OFS=, 'NR > 1 { first = $5; $5 = $6; $6 = first } 1' log.csv > swapped.csv
# Every torque is recorded six samples late, and the first ones are repeated.
awk -F, -v OFS=, '
  NR == 1 { print; next }
  { torques[NR] = $5 OFS $6 OFS $7; print $1, $2, $3, $4, torques[(NR > 7) ? NR - 6 : 2] }
' log.csv > late.csv
