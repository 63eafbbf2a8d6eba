// Harness of the `board` top module: clock, DDR and SRAM models, local-bus master, waves. Exports
// the C interface of abi.h.
#include <sys/mman.h>

#include <array>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "Vmodel.h"
#include "abi.h"
#include "coverage.h"
#include "verilated.h"
#ifdef CDE_TRACE
#include "verilated_fst_c.h"
#endif

namespace {

constexpr unsigned kSpaceSram = 3;
constexpr uint64_t kDdrBytes = 2'000'000'000;
constexpr uint64_t kSramBytes = 7 * 2097152;

/// Anonymous memory that the operating system backs page by page as it is written: a 2 GB module
/// costs what it holds.
class SparseMemory {
 public:
  explicit SparseMemory(uint64_t bytes) : bytes_(bytes) {
    void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (p == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<uint8_t*>(p);
  }
  SparseMemory(const SparseMemory&) = delete;
  SparseMemory& operator=(const SparseMemory&) = delete;
  ~SparseMemory() { munmap(data_, bytes_); }
  uint8_t* at(uint64_t byte, uint64_t size) {
    return byte + size <= bytes_ ? data_ + byte : nullptr;
  }

 private:
  uint64_t bytes_;
  uint8_t* data_;
};

/// One card: the Verilated board, its clock and the chips around it.
class Card {
 public:
  explicit Card(const cde_board_options& o)
      : options_(o),
        context_(new VerilatedContext),
        model_(new Vmodel(context_.get(), "board")),
        ddr_(kDdrBytes + 64),
        sram_(kSramBytes * (sizeof(model_->sram_write_data_o) / 28)),
        pending_(options_.ddr_latency, kNone) {
    reset();
  }
  ~Card() {
    trace_close();
    // A thread remembers the context it served last, which may be that of a card long gone.
    Verilated::threadContextp(context_.get());
    model_->final();
    cde_write_coverage(context_.get(), "board");
  }

  void reset() {
    model_->rst_i = 1;
    std::fill(pending_.begin(), pending_.end(), kNone);
    for (int i = 0; i < 4; ++i) tick();
    model_->rst_i = 0;
    tick();
  }

  uint64_t write(uint32_t space, uint32_t offset, const uint8_t* data, uint64_t beats,
                 uint64_t max_clocks) {
    uint64_t done = 0;
    model_->bus_valid_i = 1;
    model_->bus_write_i = 1;
    model_->bus_space_i = space;
    for (uint64_t limit = clocks_ + max_clocks; done < beats && clocks_ < limit;) {
      model_->bus_addr_i = offset + static_cast<uint32_t>(8 * done);
      std::memcpy(&model_->bus_wdata_i, data + 8 * done, 8);
      done += tick();
    }
    model_->bus_valid_i = 0;
    return done;
  }

  uint64_t read(uint32_t space, uint32_t offset, uint8_t* data, uint64_t beats,
                uint64_t max_clocks) {
    uint64_t asked = 0, got = 0;
    model_->bus_write_i = 0;
    model_->bus_space_i = space;
    for (uint64_t limit = clocks_ + max_clocks; got < beats && clocks_ < limit;) {
      model_->bus_valid_i = asked < beats;
      model_->bus_addr_i = space == kSpaceSram ? 0 : offset + static_cast<uint32_t>(8 * asked);
      asked += tick() && model_->bus_valid_i;
      if (model_->bus_rvalid_o) std::memcpy(data + 8 * got++, &model_->bus_rdata_o, 8);
    }
    model_->bus_valid_i = 0;
    return got;
  }

  uint64_t run(uint64_t max_clocks) {
    const uint64_t start = clocks_;
    while (!model_->irq_o && clocks_ - start < max_clocks) tick();
    return clocks_ - start;
  }
  bool interrupt() const { return model_->irq_o; }
  uint64_t clocks() const { return clocks_; }

  int trace_open([[maybe_unused]] const char* path) {
#ifdef CDE_TRACE
    trace_close();
    context_->traceEverOn(true);
    if (!trace_) {
      trace_ = std::make_unique<VerilatedFstC>();
      model_->trace(trace_.get(), 99);
    }
    trace_->open(path);
    return trace_->isOpen() ? 0 : -1;
#else
    return -1;
#endif
  }
  void trace_close() {
#ifdef CDE_TRACE
    if (trace_ && trace_->isOpen()) trace_->close();
#endif
  }

  void ddr_flip(uint64_t byte, uint8_t mask) {
    if (uint8_t* p = ddr_.at(byte, 1)) *p ^= mask;
  }

 private:
  static constexpr uint64_t kNone = ~0ull;

  /// One clock. Inputs were set by the caller; returns whether the bus beat on offer was taken.
  bool tick() {
    // What the memories answer this clock was asked for earlier.
    uint64_t& slot = pending_[clocks_ % pending_.size()];
    model_->ddr_valid_i = slot != kNone;
    if (slot != kNone) {
      if (const uint8_t* p =
              ddr_.at(slot * (sizeof(model_->ddr_data_i) / 9), sizeof(model_->ddr_data_i)))
        std::memcpy(&model_->ddr_data_i, p, sizeof(model_->ddr_data_i));
      slot = kNone;
    }
    model_->clk_i = 0;
    eval();
    const bool taken = model_->bus_valid_i && model_->bus_ready_o;
    if (model_->ddr_read_o) slot = model_->ddr_read_word_o;
    if (model_->ddr_write_o)
      if (uint8_t* p = ddr_.at(model_->ddr_write_addr_o, 8))
        std::memcpy(p, &model_->ddr_write_data_o, 8);
    if (model_->sram_write_o) {
      if (uint8_t* p = sram_.at(model_->sram_write_addr_o * kRecord, kRecord))
        std::memcpy(p, &model_->sram_write_data_o, kRecord);
    }
    const uint8_t* fetched =
        model_->sram_read_o ? sram_.at(model_->sram_read_addr_o * kRecord, kRecord) : nullptr;
    model_->clk_i = 1;
    eval();
    if (fetched) std::memcpy(&model_->sram_read_data_i, fetched, kRecord);
    ++clocks_;
    return taken;
  }

  void eval() {
    model_->eval();
#ifdef CDE_TRACE
    if (trace_ && trace_->isOpen())
      trace_->dump(clocks_ * options_.clock_period_ps +
                   (model_->clk_i ? options_.clock_period_ps / 2 : 0));
#endif
  }

  static constexpr uint64_t kRecord = sizeof(Vmodel::sram_write_data_o);
  cde_board_options options_;
  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Vmodel> model_;
#ifdef CDE_TRACE
  std::unique_ptr<VerilatedFstC> trace_;
#endif
  SparseMemory ddr_, sram_;
  std::vector<uint64_t> pending_;
  uint64_t clocks_ = 0;
};

Card* card(void* p) {
  return static_cast<Card*>(p);
}

const cde_board_api kApi = {
    CDE_BOARD_ABI,
    8 * sizeof(Vmodel::sram_write_data_o) / 7,
    CDE_CONFIG_HASH,
#include "params.inc"
    ,
    [](const cde_board_options* o) -> void* {
      try {
        return new Card(*o);
      } catch (const std::bad_alloc&) {
        return nullptr;
      }
    },
    [](void* p) { delete card(p); },
    [](void* p) { card(p)->reset(); },
    [](void* p, uint32_t space, uint32_t offset, const void* data, uint64_t beats,
       uint64_t max_clocks) {
      return card(p)->write(space, offset, static_cast<const uint8_t*>(data), beats, max_clocks);
    },
    [](void* p, uint32_t space, uint32_t offset, void* data, uint64_t beats, uint64_t max_clocks) {
      return card(p)->read(space, offset, static_cast<uint8_t*>(data), beats, max_clocks);
    },
    [](void* p, uint64_t max_clocks) { return card(p)->run(max_clocks); },
    [](void* p) { return static_cast<int>(card(p)->interrupt()); },
    [](void* p) { return card(p)->clocks(); },
    [](void* p, const char* path) { return card(p)->trace_open(path); },
    [](void* p) { card(p)->trace_close(); },
    [](void* p, uint64_t byte, uint8_t mask) { card(p)->ddr_flip(byte, mask); },
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const cde_board_api* cde_board_entry() {
  return &kApi;
}
