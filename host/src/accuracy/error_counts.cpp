// SPDX-License-Identifier: Apache-2.0
#include "cde/accuracy/error_counts.hpp"
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cde::accuracy {
namespace {

constexpr int kBins = 32;  // per octave

int bin_of(double size) {
  int exponent = 0;
  const double fraction = std::frexp(size, &exponent);  // 1/2 to 1
  return exponent * kBins + static_cast<int>((2 * fraction - 1) * kBins);
}
double upper_end(int bin) {
  const int exponent = static_cast<int>(std::floor(static_cast<double>(bin) / kBins));
  return std::ldexp(1 + static_cast<double>(bin - exponent * kBins + 1) / kBins, exponent - 1);
}

}  // namespace

void ErrorCounts::add(double size) {
  ++count_;
  if (!std::isfinite(size)) {
    ++infinite_;
  } else if (size == 0) {
    ++zeros_;
  } else {
    ++bins_[bin_of(size)];
    largest_ = std::max(largest_, size);
  }
}

void ErrorCounts::add(const ErrorCounts& other) {
  count_ += other.count_, zeros_ += other.zeros_, infinite_ += other.infinite_;
  largest_ = std::max(largest_, other.largest_);
  for (const auto& [bin, n] : other.bins_) bins_[bin] += n;
}

double ErrorCounts::quantile(double share) const {
  const auto rank =
      static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
  std::uint64_t seen = zeros_;
  if (count_ == 0 || seen >= rank) return 0;
  for (const auto& [bin, n] : bins_) {
    seen += n;
    if (seen >= rank) return std::min(upper_end(bin), largest_);
  }
  return largest();
}

double ErrorCounts::largest() const {
  return infinite_ != 0 ? std::numeric_limits<double>::infinity() : largest_;
}

nlohmann::ordered_json ErrorCounts::to_json() const {
  auto bins = nlohmann::ordered_json::array();
  for (const auto& [bin, n] : bins_) bins.push_back({bin, n});
  return {zeros_, infinite_, largest_, bins};
}

ErrorCounts ErrorCounts::from_json(const nlohmann::ordered_json& json) {
  ErrorCounts counts;
  json.at(0).get_to(counts.zeros_);
  json.at(1).get_to(counts.infinite_);
  json.at(2).get_to(counts.largest_);
  counts.count_ = counts.zeros_ + counts.infinite_;
  for (const auto& bin : json.at(3)) {
    const auto n = bin.at(1).get<std::uint64_t>();
    counts.bins_[bin.at(0).get<int>()] += n;
    counts.count_ += n;
  }
  return counts;
}

Interval95 wilson(std::uint64_t found, std::uint64_t all) {
  if (all == 0) return {0, 1};
  constexpr double kZ = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const auto n = static_cast<double>(all);
  const double p = static_cast<double>(found) / n, z2 = kZ * kZ / n;
  const double middle = (p + z2 / 2) / (1 + z2);
  const double half = kZ / (1 + z2) * std::sqrt(p * (1 - p) / n + z2 / (4 * n));
  return {found == 0 ? 0 : middle - half, found == all ? 1 : middle + half};
}

nlohmann::ordered_json share_json(std::uint64_t found, std::uint64_t all) {
  const Interval95 share = wilson(found, all);
  nlohmann::ordered_json json = {
      {"count", found}, {"per_million", nullptr}, {"interval_95", nullptr}};
  if (all == 0) return json;
  json["per_million"] = 1e6 * static_cast<double>(found) / static_cast<double>(all);
  json["interval_95"] = {1e6 * share.low, 1e6 * share.high};
  return json;
}

}  // namespace cde::accuracy
