#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# cde fp: TestFloat's line format, names and errors. Usage: cli.sh CDE fp32|formats; `formats` also builds units of the
# other formats.
set -euo pipefail
cde=$1
failures=0
# expect WANT_STATUS WANT_OUTPUT INPUT ARGUMENTS... On stderr only the first line counts, and only if the status is not
# 0.
expect() {
  local status=0 got want_status=$1 want=$2 input=$3
  shift 3
  got=$(printf '%b' "$input" | "$cde" fp "$@" 2>/tmp/cde-fp-err.$$) || status=$?
  [[ $status == 0 ]] || got=$(head -1 /tmp/cde-fp-err.$$)
  rm -f /tmp/cde-fp-err.$$
  # shellcheck disable=SC2053  # the expected output may be a pattern
  if [[ $status != "$want_status" || $got != $want ]]; then
    printf 'cde fp %s: status %s, expected %s\n  got      %s\n  expected %s\n' "$*" "$status" "$want_status" "$got" "$want" >&2
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

# The line format of testfloat_gen and testfloat_ver (Berkeley TestFloat 3, doc/testfloat_ver.html and its writeHex.c).
# A line holds operands, result and flags, with one space between them, in upper case, and ends with a line feed.
# Words have the digits of their type: 4 for f16; 8 for f32, i32 and ui32; 16 for f64, i64 and ui64.
# Comparisons answer 0 or 1. Flags are two digits.
# Input may be lower case, and may end with carriage return and line feed.
# Comparisons lt and le signal on a quiet NaN, eq does not.
# Usage: line LANES OPERATION OPERANDS RESULT_AND_FLAGS
line() {
  local arith
  for arith in rtl host; do expect 0 "$3 $4" "$3\n" "$2" --lanes "$1" --arith $arith; done
}
line 8 f32_sqrt '40000000' '3FB504F3 01'
line 8 f32_to_bf16 '3F818000' '3F82 01'
line 8 f32_to_i32_rx_minMag '3FC00000' '00000001 01'
line 8 f32_to_i32_r_minMag '3FC00000' '00000001 00'
if [[ $2 == formats ]]; then
  # Formats that fill their 32-bit container: a product, a carry, an overflow.
  for arith in rtl host; do
    expect 0 'D3920869 D3920869 683BAF35 01' 'D3920869 D3920869\n' mul -f e7m24 --lanes 2 --arith $arith
    expect 0 '6FFFFFFF 6FFFFFFF 70000000 05' '6FFFFFFF 6FFFFFFF\n' add -f e3m28 --lanes 2 --arith $arith
    expect 0 '6FFFFFFF 00000001 70000000 05' '6FFFFFFF 00000001\n' div -f e3m28 --lanes 2 --arith $arith
  done
  line 4 f16_mul '3C01 4000' '4001 00'
  line 2 f64_add '3FF0000000000000 4000000000000000' '4008000000000000 00'
  line 2 f64_add '7FEFFFFFFFFFFFFF 7FEFFFFFFFFFFFFF' '7FF0000000000000 05'
  line 2 f64_lt '3FF0000000000000 7FF8000000000000' '0 10'
  line 2 f64_le 'BFF0000000000000 3FF0000000000000' '1 00'
  line 2 f64_eq '3FF0000000000000 7FF8000000000000' '0 00'
  line 2 f64_to_f16 '3FF0000000000000' '3C00 00'
  line 2 i64_to_f64 'FFFFFFFFFFFFFFFF' 'BFF0000000000000 00'
  line 4 ui64_to_f16 'FFFFFFFFFFFFFFFF' '7C00 05'
  line 2 f64_to_ui32 '41F0000000000000' 'FFFFFFFF 10'
  line 2 f64_to_i64 'BFF8000000000000' 'FFFFFFFFFFFFFFFE 01'
  # Rounding in the name: _rx_ raises inexact, _r_ never does.
  line 2 f64_to_i64_rx_near_even 'BFF8000000000000' 'FFFFFFFFFFFFFFFE 01'
  line 2 f64_to_i64_r_near_even 'BFF8000000000000' 'FFFFFFFFFFFFFFFE 00'
  line 2 f64_to_i64_rx_minMag 'BFF8000000000000' 'FFFFFFFFFFFFFFFF 01'
  line 2 f64_to_i64_r_minMag 'BFF8000000000000' 'FFFFFFFFFFFFFFFF 00'
  line 2 f64_to_i64_r_minMag '7FF8000000000000' '7FFFFFFFFFFFFFFF 10'
fi
expect 0 $'3F80ABCE 40000000 404055E7 00' '3f80abce 40000000\r\n' f32_add "${unit[@]}" rtl
[[ $(printf '3F800000 40000000\n' | "$cde" fp f32_add "${unit[@]}" rtl | od -An -c | tr -d ' \n') == '3F800000400000004040000000\n' ]] ||
  { echo "cde fp: a line must end with a single line feed" >&2; failures=$((failures + 1)); }
expect 2 "*operation 'f32_add_rx_minMag'*" '' f32_add_rx_minMag "${unit[@]}" host
# As a coprocess: every line is answered while the pipe stays open, also a line that arrives in two parts.
coproc FP { exec "$cde" fp f32_add "${unit[@]}" host; }
answered=''
for sum in '3F800000 40000000 40400000 00' '40000000 40000000 40800000 00'; do
  read -r a b _ <<<"$sum"
  printf '%s %s' "$a" "${b:0:3}" >&"${FP[1]}"
  printf '%s\n' "${b:3}" >&"${FP[1]}"
  read -r -t 60 answer <&"${FP[0]}" || answer='nothing'
  [[ $answer == "$sum" ]] || answered+=" '$answer' for '$sum'"
done
pid=$FP_PID
in=${FP[1]}
exec {in}>&-
wait "$pid"
[[ -z $answered ]] || { echo "cde fp as a coprocess gave wrong answers:$answered" >&2; failures=$((failures + 1)); }
# Lines before a bad line are answered, lines after it are not.
good=$(printf '3F800000 40000000\nx 1\n40000000 40000000\n' | "$cde" fp add "${unit[@]}" host 2>/dev/null) && failures=$((failures + 1))
[[ $good == '3F800000 40000000 40400000 00' ]] || { echo "cde fp: wrong output before a bad line: '$good'" >&2; failures=$((failures + 1)); }
expect 2 "*stdin line 2: operand 1 is not hexadecimal: 'x 1'*" '1 1\nx 1\n' add "${unit[@]}" host
expect 2 "*stdin line 1: 2 operands wanted, 1 found*" '3F800000\n' add "${unit[@]}" host
expect 2 "*stdin line 1: operand 2 has more than 32 bits*" '1 123456789\n' add "${unit[@]}" host
expect 2 "*operation 'plus'*" '' plus "${unit[@]}" host
expect 2 "*format 'fp12'*" '' add --format fp12 "${unit[@]}" host
expect 2 "*cannot be combined with f32_add*" '' f32_add --format fp16 "${unit[@]}" host
exit $((failures > 0))
