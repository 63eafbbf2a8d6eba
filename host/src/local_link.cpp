#include <fmt/format.h>

#include <cstring>

#include "abi.h"
#include "card_link.hpp"
#include "cde/error.hpp"

namespace cde {
namespace {

constexpr std::uint64_t kAccessClocks = 1000;  // no single access takes this long

class LocalLink final : public CardLink {
 public:
  LocalLink(Bitstream bitstream, const OpenOptions& options)
      : bitstream_(std::move(bitstream)), period_ps_(options.clock_period_ps) {
    api_ = reinterpret_cast<cde_board_entry_fn>(bitstream_.symbol("cde_board_entry"))();
    if (api_->abi != CDE_BOARD_ABI) {
      throw Error(ErrorCode::kConfiguration,
                  fmt::format("bitstream {}: C interface version {}, this driver speaks {}",
                              bitstream_.path().string(), api_->abi, CDE_BOARD_ABI));
    }
    const cde_board_options card_options = {options.ddr_latency, options.clock_period_ps};
    card_ = api_->create(&card_options);
    if (card_ == nullptr) throw Error(ErrorCode::kDevice, "no memory for the card's models");
  }
  LocalLink(const LocalLink&) = delete;
  LocalLink& operator=(const LocalLink&) = delete;
  ~LocalLink() override { api_->destroy(card_); }

  void write(card::Space space, std::uint32_t offset, const void* data,
             std::uint64_t beats) override {
    transferred(api_->write(card_, space, offset, data, beats, beats * 4 + kAccessClocks), beats,
                "written to", space, offset);
  }
  void read(card::Space space, std::uint32_t offset, void* data, std::uint64_t beats) override {
    transferred(api_->read(card_, space, offset, data, beats, beats * 4 + kAccessClocks), beats,
                "read from", space, offset);
  }

  std::uint64_t run(std::uint64_t max_clocks) override { return api_->run(card_, max_clocks); }
  bool interrupt() override { return api_->interrupt(card_) != 0; }
  [[nodiscard]] std::uint64_t clocks() const override { return api_->clocks(card_); }
  [[nodiscard]] std::uint64_t time_ps() const override { return clocks() * period_ps_; }
  [[nodiscard]] BusCounters counters() const override { return counters_; }
  void reset() override { api_->reset(card_); }
  void alive() const override {}
  [[nodiscard]] bool lost() const override { return false; }
  [[nodiscard]] std::uint16_t pci_status() override { return 0; }
  [[nodiscard]] std::string violation() const override { return {}; }
  void inject(BusFault fault, std::uint32_t count, std::uint32_t) override {
    if (fault != BusFault::kHang) {
      throw Error(ErrorCode::kUsage,
                  fmt::format("the functional bus has no fault '{}', only '{}'; open the board "
                              "with Bus::kCycle",
                              name_of(fault), name_of(BusFault::kHang)));
    }
    api_->ddr_hang(card_, count);
  }

  void trace_open(const std::filesystem::path& file) override {
    if (std::strstr(api_->parameters, "TRACE=1") == nullptr) {
      throw Error(ErrorCode::kUsage,
                  "this bitstream has no waves; open the board with BoardConfig::trace");
    }
    if (api_->trace_open(card_, file.c_str()) != 0)
      throw Error(ErrorCode::kFile, fmt::format("{}: cannot write waves", file.string()));
  }
  void trace_close() override { api_->trace_close(card_); }
  bool flip_ddr(std::uint64_t byte, std::uint8_t mask) override {
    return api_->ddr_flip(card_, byte, mask) == 0;
  }
  bool flip_check(std::uint64_t word, std::uint8_t mask) override {
    return api_->check_flip(card_, word, mask) == 0;
  }
  [[nodiscard]] std::uint64_t config_hash() const override { return api_->config_hash; }

 private:
  void transferred(std::uint64_t done, std::uint64_t wanted, const char* what, card::Space space,
                   std::uint32_t offset) const {
    if (done == wanted) return;
    throw Error(ErrorCode::kDevice,
                fmt::format("local bus hangs: {} of {} beats {} space {} offset {:#x} at clock {}",
                            done, wanted, what, static_cast<int>(space), offset, clocks()));
  }

  Bitstream bitstream_;
  std::uint32_t period_ps_;
  BusCounters counters_;
  const cde_board_api* api_ = nullptr;
  void* card_ = nullptr;
};

}  // namespace

std::unique_ptr<CardLink> local_link(Bitstream bitstream, const OpenOptions& options) {
  return std::make_unique<LocalLink>(std::move(bitstream), options);
}

}  // namespace cde
