#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "cde/board.hpp"

namespace cde {

/// The way from the driver to a card: accesses to its four spaces over whichever bus it is plugged
/// into, and its interrupt. Times are the card's: core clocks since power-on. Private to the
/// driver.
class CardLink {
 public:
  virtual ~CardLink() = default;

  /// `beats` transfers of 64 bits at byte offset, offset + 8, ... (SRAM: the offset stays 0). What
  /// the card refuses shows in its status register. Error kDevice if the bus does not transfer
  /// them.
  virtual void write(card::Space space, std::uint32_t offset, const void* data,
                     std::uint64_t beats) = 0;
  virtual void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) = 0;

  /// Lets the card work until its interrupt, at most so many core clocks; returns those spent.
  virtual std::uint64_t run(std::uint64_t max_clocks) = 0;
  [[nodiscard]] virtual bool interrupt() = 0;
  [[nodiscard]] virtual std::uint64_t clocks() const = 0;
  virtual void reset() = 0;

  /// Error kUsage if the bitstream has no waves, kFile if the file cannot be written.
  virtual void trace_open(const std::filesystem::path& file) = 0;
  virtual void trace_close() = 0;
  virtual void flip_ddr(std::uint64_t byte, std::uint8_t mask) = 0;

  /// Of the loaded bitstream, whatever its card says.
  [[nodiscard]] virtual std::uint64_t config_hash() const = 0;
};

/// The local bus itself, driven by the harness: one beat a core clock. Errors: kConfiguration if
/// the bitstream speaks another interface, kDevice if there is no memory for the card.
[[nodiscard]] std::unique_ptr<CardLink> local_link(Bitstream bitstream, const OpenOptions& options);

}  // namespace cde
