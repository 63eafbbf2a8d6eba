#!/usr/bin/env bash
# cde fp: TestFloat's line format, names and errors. Usage: cli.sh CDE
set -euo pipefail
cde=$1
failures=0
# expect WANT_STATUS WANT_OUTPUT INPUT ARGUMENTS...; of stderr only the first line counts, and only when the status is not 0
expect() {
  local status=0 got want_status=$1 want=$2 input=$3
  shift 3
  got=$(printf '%b' "$input" | "$cde" fp "$@" 2>/tmp/cde-fp-err.$$) || status=$?
  [[ $status == 0 ]] || got=$(head -1 /tmp/cde-fp-err.$$)
  rm -f /tmp/cde-fp-err.$$
  # shellcheck disable=SC2053  # what is wanted may be a pattern
  if [[ $status != "$want_status" || $got != $want ]]; then
    printf 'cde fp %s: status %s, wanted %s\n  got    %s\n  wanted %s\n' "$*" "$status" "$want_status" "$got" "$want" >&2
    failures=$((failures + 1))
  fi
}
unit=(--lanes 8 --arith)
for arith in rtl host; do
  expect 0 $'3F800000 40000000 40400000 00\n7F800000 FF800000 7FC00000 10' '3f800000 40000000\n7F800000 FF800000\n' add "${unit[@]}" $arith
  expect 0 '3F800000 00000000 7F800000 08' '3F800000 00000000 7F800000 08\n' f32_div "${unit[@]}" $arith
  expect 0 '00000001 3F000000 00000000 03' '00000001 3F000000' mul "${unit[@]}" $arith
  expect 0 '3F800000 40000000 1 00' '3F800000 40000000\n\n' f32_lt "${unit[@]}" $arith
  expect 0 '40400000 00000003 00' '40400000\n' f32_to_i32 "${unit[@]}" $arith
  expect 0 '477FF000 7C00 05' '477FF000\n' f32_to_f16 "${unit[@]}" $arith
  expect 0 'FFFFFFFF BF800000 00' 'ffffffff\n' i32_to_f32 "${unit[@]}" $arith
  expect 0 '' '' add "${unit[@]}" $arith
done
expect 2 "*stdin line 2: operand 1 is not hexadecimal: 'x 1'*" '1 1\nx 1\n' add "${unit[@]}" host
expect 2 "*stdin line 1: 2 operands wanted, 1 found*" '3F800000\n' add "${unit[@]}" host
expect 2 "*stdin line 1: operand 2 has more than 32 bits*" '1 123456789\n' add "${unit[@]}" host
expect 2 "*operation 'plus'*" '' plus "${unit[@]}" host
expect 2 "*format 'fp12'*" '' add --format fp12 "${unit[@]}" host
expect 2 "*is not of format fp16*" '' f32_add --format fp16 "${unit[@]}" host
exit $((failures > 0))
