// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "card/card_pass.hpp"

namespace cde {

/// Describes the card's error about malformed nodes. Private to the driver.
[[nodiscard]] std::string node_fault(Board::Impl& card, std::uint64_t fault);

/// Refits the boxes of the nodes [first, end). Private to the driver.
class RefitPass : private CardPass {
 public:
  explicit RefitPass(Board::Impl& card, const Query& query) : CardPass(card, query) {}
  Counters execute(std::uint32_t first, std::uint32_t end);

 private:
  [[nodiscard]] std::string state() override;
};

/// A pass of rays or solids through the BVH in the card. The driver writes the primaries into a
/// ring while the card works. Records arrive in any order, and the driver sorts them. Private to
/// the driver.
class BvhPass : private CardPass {
 public:
  /// Writes the words of a ray of the pass, as many as its shape has.
  using Rays = std::function<void(std::uint32_t, std::uint32_t*)>;

  /// `numbers` are the numbers of the rays in records, ascending, one per ray. All arguments must
  /// outlive the pass.
  BvhPass(Board::Impl& card, const Query& query, std::span<const std::uint32_t> numbers,
          const Rays& rays);

  /// Runs the pass to its last record. Modes with one record per ray sort by number. Mode hits
  /// sorts by packet of the card, then index, then number. These are the orders of a brute-force
  /// pass.
  Counters execute(std::vector<Record>& records);

 private:
  [[nodiscard]] std::string state() override;
  void configure();
  /// Writes at most `most` rays into free places. Returns whether all rays are written.
  bool provide(std::uint32_t most);
  void write_rays(std::uint32_t count);
  [[nodiscard]] std::uint32_t taken() const;  ///< rays whose places are free again
  void wait_until_done();
  [[nodiscard]] std::uint64_t until_deadline(std::uint64_t cycles) const;
  void check_progress();
  void drain(std::uint64_t entries);
  /// Takes a record, or the normal of the last record.
  void take(const std::uint32_t* entry);
  Counters finish();
  void put_in_order(std::vector<Record>& records);

  std::span<const std::uint32_t> numbers_;
  bool normals_, has_half_ = false;
  std::uint64_t received_ = 0;  ///< ring entries
  unsigned place_words_;        ///< words per ray in the ring
  std::uint32_t places_;
  const Rays& rays_;
  std::uint32_t provided_ = 0, taken_ = 0;
  std::uint64_t ray_ps_ = 0;                      ///< spent writing rays
  std::uint64_t last_nodes_ = 0, last_progress_;  ///< clock of the last progress
  std::vector<std::uint32_t> ray_words_;
  std::vector<Record> records_;
};

}  // namespace cde
