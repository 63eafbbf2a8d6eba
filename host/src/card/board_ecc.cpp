// SPDX-License-Identifier: Apache-2.0
// Finds the DDR word with an uncorrectable error. The card only counts such words.
#include <fmt/format.h>

#include <algorithm>

#include "card/board_impl.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

constexpr std::uint64_t kCyclesPerSecondary = 2048;  // the most, of a cylinder pipe
constexpr std::uint64_t kCyclesPerPass = 100'000;

}  // namespace

/// Whether a pass with no primary over these secondaries finds an uncorrectable error.
bool Board::Impl::uncorrectable(std::uint32_t first, std::uint32_t count) {
  write_register(card::kRegControl, card::kControlClear);
  write_register(card::kRegSecFirst, first);
  write_register(card::kRegSecCount, count);
  write_register(card::kRegControl, card::kControlGo);
  const std::uint64_t end = cycles() + kCyclesPerPass + count * kCyclesPerSecondary;
  // An interrupt of the previous pass may still arrive, so this loop checks the status.
  do {
    link->run(std::min(end - cycles(), kCyclesPerPass));
    (void)link->interrupt();
  } while ((read_register(card::kRegStatus) >> card::kStatusBusy & 1) != 0 && cycles() < end);
  const std::uint64_t status = read_register(card::kRegStatus);
  if ((status >> card::kStatusBusy & 1) != 0) {
    throw Error(ErrorCode::kTimeout,
                fmt::format("words of DDR have uncorrectable errors, and a pass that searches for "
                            "them did not end (status {:#x}, cycle {})",
                            status, cycles()),
                link->fault());
  }
  const bool found = card::kEccFailed.of(read_register(card::kRegEcc)) != 0;
  write_register(card::kRegControl, card::kControlClear);
  return found;
}

std::optional<std::uint64_t> Board::Impl::find_uncorrectable(std::uint64_t command) {
  write_register(card::kRegCommand, command);
  write_register(card::kRegPrimCount, 1);
  for (unsigned base = 0; base < primaries; base += 64)
    write_register(card::kRegStencil + base / 8, ~std::uint64_t{0});
  if (objects.entries != 0) write_register(card::kRegObjectCount, 0);
  if (primary_objects.entries != 0) write_register(card::kRegPrimObjectCount, 0);
  std::uint32_t first = 0, count = secondaries;
  if (!uncorrectable(first, count)) return std::nullopt;
  while (count > 1) {
    const std::uint32_t half = count / 2;
    const bool lower = uncorrectable(first, half);
    if (!lower) first += half;
    count = lower ? half : count - half;
  }
  return std::uint64_t{first} * 4 * words(secondary_shape);
}

}  // namespace cde
