// SPDX-License-Identifier: Apache-2.0
#include "cde/card/fault.hpp"

#include <fmt/format.h>

#include <vector>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "support/text.hpp"

namespace cde {
namespace {

constexpr const char* kDdr = "ddr";

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  for (std::size_t end = 0; end != text.npos;) {
    end = text.find(at);
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return parts;
}

/// Whether a fault has a `value` in Board::inject besides its count.
bool has_value(BusFault fault) {
  switch (fault) {
    case BusFault::kSlow:
    case BusFault::kDisconnect:
    case BusFault::kDisconnectEmpty:
    case BusFault::kParity:
    case BusFault::kTargetAbort:
    case BusFault::kGrant:
      return true;
    default:
      return false;
  }
}

std::string kinds() {
  std::string all;
  for (std::uint32_t i = 0; i < kBusFaults; ++i)
    all += fmt::format("{}, ", name_of(static_cast<BusFault>(i)));
  return all + kDdr;
}

}  // namespace

ScheduledFault fault_of(std::string_view text) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::kUsage, fmt::format("fault {}: {}", in_quotes(text), why));
  };
  const auto number = [&](std::string_view part, const char* what, std::uint32_t least) {
    std::uint32_t n = 0;
    if (!text::parse_int(part, n) || n < least)
      refuse(fmt::format("{} is {}; it must be a whole number from {} on", what, in_quotes(part),
                         least));
    return n;
  };
  ScheduledFault fault;
  const std::vector<std::string_view> halves = split(text, '@');
  const std::vector<std::string_view> parts = split(halves.front(), ':');
  if (halves.size() != 2 || parts.size() > 3) refuse("it must be KIND[:COUNT[:VALUE]]@FRAME");
  fault.bus = fault_named(parts[0]);
  if (!fault.bus && parts[0] != kDdr)
    refuse(fmt::format("there is no kind {}; it must be one of {}", in_quotes(parts[0]), kinds()));
  fault.frame = number(halves[1], "FRAME", 0);
  if (parts.size() > 1) {
    const bool all = fault.bus && parts[1] == "all";
    fault.count = all ? kUntilReset : number(parts[1], "COUNT", 1);
  }
  if (parts.size() > 2) {
    if (fault.bus && !has_value(*fault.bus))
      refuse(fmt::format("{} takes no VALUE; it must be KIND[:COUNT]@FRAME", parts[0]));
    fault.value = number(parts[2], "VALUE", 0);
  }
  if (!fault.bus && (fault.value < 1 || fault.value > 32))
    refuse(fmt::format("VALUE is {}; a word of DDR can have 1 to 32 wrong bits", fault.value));
  return fault;
}

std::string text_of(const ScheduledFault& fault) {
  const std::string count =
      fault.bus && fault.count == kUntilReset ? "all" : fmt::format("{}", fault.count);
  const std::string value =
      !fault.bus || has_value(*fault.bus) ? fmt::format(":{}", fault.value) : "";
  return fmt::format("{}:{}{}@{}", fault.bus ? name_of(*fault.bus) : kDdr, count, value,
                     fault.frame);
}

void check_fault(const ScheduledFault& fault, const BoardConfig& board) {
  if (!fault.bus || board.bus == Bus::kCycle || on_functional_bus(*fault.bus)) return;
  throw Error(
      ErrorCode::kUsage,
      fmt::format("fault {}: the functional bus has no such fault; it needs bus = \"cycle\"",
                  in_quotes(text_of(fault))));
}

}  // namespace cde
