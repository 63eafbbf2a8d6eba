// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "card/card_pass.hpp"

namespace cde {

/// What the card says of nodes that are no tree's. Private to the driver.
[[nodiscard]] std::string node_fault(Board::Impl& card, std::uint64_t fault);

/// Boxes anew, of nodes from the first one on up to the end. Private to the driver.
class RefitPass : private CardPass {
 public:
  explicit RefitPass(Board::Impl& card, const Query& query) : CardPass(card, query) {}
  Counters execute(std::uint32_t first, std::uint32_t end);

 private:
  [[nodiscard]] std::string state() override;
};

/// A pass of rays, or of solids, through the hierarchy in the card: they are written into a ring
/// while it works, and its records, which come as they are found, are put in order. Private to the
/// driver.
class HierarchyPass : private CardPass {
 public:
  /// The words of a ray of the pass, as many as its shape has.
  using Rays = std::function<void(std::uint32_t, std::uint32_t*)>;

  /// `numbers` are those of the rays in records, ascending, one a ray of the pass; all outlives it.
  HierarchyPass(Board::Impl& card, const Query& query, std::span<const std::uint32_t> numbers,
                const Rays& rays);

  /// From go to the last record. Those of modes that keep one a ray come by ascending number, those
  /// of hits packet by packet (primaries of the card), in it by index, then number: the orders of
  /// sweeps.
  Counters execute(std::vector<Record>& records);

 private:
  [[nodiscard]] std::string state() override;
  void configure();
  /// Writes rays as far as there are places, at most so many; whether all are written.
  bool provide(std::uint32_t most);
  void write_rays(std::uint32_t count);
  [[nodiscard]] std::uint32_t taken() const;  ///< whose places are free again
  void wait_until_done();
  [[nodiscard]] std::uint64_t until_deadline(std::uint64_t clocks) const;
  void check_progress();
  void drain(std::uint64_t entries);
  /// A record, or the normal of the one before.
  void take(const std::uint32_t* entry);
  Counters finish();
  void put_in_order(std::vector<Record>& records);

  std::span<const std::uint32_t> numbers_;
  bool normals_, has_half_ = false;
  std::uint64_t received_ = 0;  ///< entries of the ring
  unsigned place_words_;        ///< of a ray in the ring
  std::uint32_t places_;
  const Rays& rays_;
  std::uint32_t provided_ = 0, taken_ = 0;
  std::uint64_t ray_ps_ = 0;                      ///< spent in writing rays
  std::uint64_t last_nodes_ = 0, last_progress_;  ///< clock at which something had been read
  std::vector<std::uint32_t> ray_words_;
  std::vector<Record> records_;
};

}  // namespace cde
