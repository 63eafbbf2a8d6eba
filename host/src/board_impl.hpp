#pragma once
#include "card_link.hpp"
#include "cde/board.hpp"

namespace cde {

/// State of a Board, and single accesses to its card. Private to the driver.
class Board::Impl {
 public:
  Impl(std::unique_ptr<CardLink> way, std::filesystem::path file)
      : link(std::move(way)), bitstream(std::move(file)) {}

  [[nodiscard]] std::uint64_t read_register(std::uint32_t offset);
  void write_register(std::uint32_t offset, std::uint64_t value);
  [[nodiscard]] std::uint64_t clocks() const { return link->clocks(); }

  /// Throws kDevice with the fault address if an access was refused, after clearing it.
  void check_bus(const char* during);

  /// Primaries into the register file from slot `first` on. Error kUsage if they do not fit.
  void load(std::uint32_t first, Shape shape, std::size_t count,
            const std::function<void(std::size_t, float*)>& words);
  /// Slot of the second pair's first primary: rows are not shared.
  [[nodiscard]] std::uint32_t split() const { return (loaded + lanes - 1) / lanes * lanes; }

  std::unique_ptr<CardLink> link;
  std::filesystem::path bitstream;
  unsigned lanes = 0, primaries = 0, pipe_latency = 0, ddr_latency = 0;
  std::uint64_t capacity = 0, sram_records = 0;  ///< bytes of DDR
  std::uint32_t secondaries = 0;                 ///< uploaded
  std::uint32_t loaded = 0;                      ///< primaries in the register file
  std::uint32_t second_loaded = 0;  ///< those of the second pair, behind them on the next full row
  Shape secondary_shape = Shape::kTriangle, primary_shape = Shape::kRay, second_shape = Shape::kRay;
  std::vector<Pair> pairs;
  bool can_swap = false, has_normals = false, parallel = false;
  unsigned slot_words = 0;      ///< of a primary
  unsigned facet_interval = 1;  ///< clocks from row to row of pairs with facets
  std::uint64_t upload_clocks = 0, load_clocks = 0, pass_retries = 0;
  unsigned pass_retry_limit = 0;
};

}  // namespace cde
