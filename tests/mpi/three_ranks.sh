#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#   three_ranks.sh MPIRUN PROGRAM
set -euo pipefail
command -v "$1" >/dev/null || { echo "mpi: skipped, mpirun is not installed (tools/setup test)"; exit 77; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
exec "$1" --oversubscribe -n 3 "$2"
