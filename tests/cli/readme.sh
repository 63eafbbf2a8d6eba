#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every `$ build/cde ...` example of a document and compares what it prints with what the document shows, line by line in any
# order (data and summary go to different streams). Lines about wall time differ from run to run and are left out.
#
#   readme.sh CDE DOCUMENT      run in the root of the source tree
set -euo pipefail
cde=$1 document=$2 examples=0 failures=0
comparable() { grep -v -e '^simulation ' -e '^cde: building ' | sort; }
while IFS= read -r number; do
  command=$(sed -n "${number}s/^    \$ build\/cde //p" "$document")
  # Reads to the end: who leaves a pipe early may end its writer with SIGPIPE.
  wanted=$(awk -v after="$number" 'NR <= after || over { next } /^    [^$]/ { print substr($0, 5); next } { over = 1 }' "$document")
  got=$(eval "\"$cde\" $command" 2>&1)
  examples=$((examples + 1))
  diff <(comparable <<<"$wanted") <(comparable <<<"$got") || { echo "$document:$number: cde $command prints something else" >&2; failures=$((failures + 1)); }
done < <(grep -n '^    \$ build/cde ' "$document" | cut -d: -f1)
echo "$examples examples of $document, $failures differ"
[[ $examples -gt 0 && $failures == 0 ]]
