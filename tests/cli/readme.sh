#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every `$ build/cde ...` example of a document and compares the output with the document. Lines match in any
# order, because data and summary go to different streams. Lines with wall time or build progress are ignored. A line
# `...` in the document stands for any further lines.
#
#   readme.sh CDE DOCUMENT      run in the root of the source tree; examples run next to its meshes/ and write to a
#                               temporary folder
set -euo pipefail
cde=$1 document=$PWD/$2 examples=0 failures=0
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
ln -s "$PWD/meshes" "$scratch/meshes"
cd "$scratch"
comparable() { grep -v -e '^simulation ' -e '^cde: building ' -e '^cde: built in ' -e '^cde: [0-9]* s, ' -e '^cde: reading the structure ' -e '^\.\.\.$' | LC_ALL=C sort; }
while IFS= read -r number; do
  command=$(sed -n "${number}s/^    \$ build\/cde //p" "$document")
  # Reads to the end: a reader that stops early may end the writer with SIGPIPE.
  wanted=$(awk -v after="$number" 'NR <= after || over { next } /^    [^$]/ { print substr($0, 5); next } { over = 1 }' "$document")
  got=$(eval "\"$cde\" $command" 2>&1 </dev/null)
  examples=$((examples + 1))
  # For complete output diff shows both sides. For shortened output comm shows the lines that the command did not print.
  if grep -qx '\.\.\.' <<<"$wanted"; then
    difference=$(LC_ALL=C comm -23 <(comparable <<<"$wanted") <(comparable <<<"$got"))
  else
    difference=$(diff <(comparable <<<"$wanted") <(comparable <<<"$got") || true)
  fi
  [[ -z $difference ]] || { printf '%s\n%s:%s: the output of cde %s differs\n' "$difference" "$2" "$number" "$command" >&2; failures=$((failures + 1)); }
done < <(grep -n '^    \$ build/cde ' "$document" | cut -d: -f1)
echo "$examples examples in $2, $failures with differences"
[[ $examples -gt 0 && $failures == 0 ]]
