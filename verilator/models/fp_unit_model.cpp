// SPDX-License-Identifier: Apache-2.0
// Harness of the `fp_unit` top module: clocks only the requested operation. Exports the C interface
// of abi_fp.h.
#include <array>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <new>
#include <random>
#include <string_view>

#include "Vmodel.h"
#include "cde/abi/abi_fp.h"
#include "cde/contract/formats.hpp"
#include "coverage.h"
#include "parameters.h"
#include "verilated.h"

namespace {

using cde::FpOp;
constexpr uint32_t code(FpOp op) {
  return static_cast<uint32_t>(op);
}

constexpr unsigned kExp = parameter("EXP", 8), kMan = parameter("MAN", 23),
                   kLanes = parameter("LANES", 16), kBLanes = parameter("B_LANES", kLanes);
// Operations per cycle. If all lanes share one b, it is one operation, in a lane that changes every
// cycle, while the other lanes keep earlier operands.
constexpr unsigned kRow = kBLanes == kLanes ? kLanes : 1;
constexpr uint32_t kOps = uint32_t(parameter("OPS", -1)) & (~0u >> (32 - cde::kFpOps));
constexpr unsigned kArithmetic = cde::kFpArithmetic;
using Container = std::conditional_t<(1 + kExp + kMan <= 32), uint32_t, uint64_t>;

constexpr uint32_t latency_of(uint32_t op) {
  if (op <= code(FpOp::kSub)) return parameter("LAT_ADD", 1);
  if (op == code(FpOp::kMul)) return parameter("LAT_MUL", 1);
  if (op == code(FpOp::kDiv)) return parameter("LAT_DIV", 1);
  if (op == code(FpOp::kSqrt)) return parameter("LAT_SQRT", 1);
  if (op <= code(FpOp::kMax)) return parameter("LAT_CMP", 1);
  return parameter("LAT_CVT", 1);
}

bool present(uint32_t op) {
  return op < cde::kFpOps && ((kOps >> op) & 1) != 0;
}
bool integer_operand(uint32_t op) {
  return op >= code(FpOp::kFromI32) && op <= code(FpOp::kFromUi64);
}
bool comparison(uint32_t op) {
  return op >= code(FpOp::kLt) && op <= code(FpOp::kEq);
}

}  // namespace

struct cde_fp_unit {
  // Verilator's C++ types of ports are little-endian words, so lane l of width W is at byte l * W /
  // 8.
  VerilatedContext context;
  Vmodel model{&context, "fp_unit"};
  Container* a = reinterpret_cast<Container*>(&model.a_i);
  Container* b = reinterpret_cast<Container*>(&model.b_i);
  uint64_t* n = reinterpret_cast<uint64_t*>(&model.n_i);
  const Container* r = reinterpret_cast<const Container*>(&model.r_o);
  const Container* f = reinterpret_cast<const Container*>(&model.f_o);
  const uint64_t* x = reinterpret_cast<const uint64_t*>(&model.x_o);
  const uint32_t* g = reinterpret_cast<const uint32_t*>(&model.g_o);

  cde_fp_unit() {
    model.clk_i = 0;
    model.eval();
  }
  ~cde_fp_unit() {
    Verilated::threadContextp(&context);  // the thread may remember a destroyed unit's context
    model.final();
    cde_write_coverage(&context, "fp_unit");
  }
  cde_fp_unit(const cde_fp_unit&) = delete;
  cde_fp_unit& operator=(const cde_fp_unit&) = delete;

  void clock(uint32_t op) {
    model.clk_i = 1u << op;
    model.eval();
    model.clk_i = 0;
    model.eval();
  }
  /// Lane of a row's first operation.
  static uint64_t first_lane(uint64_t row) { return row * kRow % kLanes; }

  void set(uint32_t op, uint64_t row, const uint64_t* pa, const uint64_t* pb, uint64_t count) {
    for (uint64_t l = 0; l < count; l++) {
      if (integer_operand(op))
        n[first_lane(row) + l] = pa[l];
      else
        a[first_lane(row) + l] = Container(pa[l]);
    }
    if (pb == nullptr) return;
    for (uint64_t l = 0; l < count; l++) b[l] = Container(pb[l]);
  }
  void get(uint32_t op, uint64_t row, uint64_t* pr, uint8_t* pf, uint64_t count) const {
    for (uint64_t l = 0; l < count; l++) {
      const uint64_t at = (op < kArithmetic ? op : op - kArithmetic) * kLanes + first_lane(row) + l;
      pr[l] = op < kArithmetic ? uint64_t{r[at]} : x[at];
      if (comparison(op))
        pr[l] = pr[l] == Container(~Container{0})
                    ? 1
                    : pr[l];  // a mask that is neither all ones nor zero stays visible
      if (pf != nullptr) pf[l] = uint8_t(op < kArithmetic ? f[at] : g[at]);
    }
  }
};

namespace {

cde_fp_unit* create() {
  return new (std::nothrow) cde_fp_unit;
}
void destroy(cde_fp_unit* u) {
  delete u;
}
uint32_t latency(const cde_fp_unit*, uint32_t op) {
  return present(op) ? latency_of(op) : 0;
}

int apply(cde_fp_unit* u, uint32_t op, const uint64_t* a, const uint64_t* b, uint64_t* r,
          uint8_t* flags, uint64_t n) {
  if (!present(op)) return 1;
  const bool binary = op < kArithmetic && op != code(FpOp::kSqrt);
  const uint64_t rows = (n + kRow - 1) / kRow, lat = latency_of(op);
  const auto size = [n](uint64_t row) { return std::min<uint64_t>(kRow, n - row * kRow); };
  for (uint64_t t = 0; t + 1 < rows + lat; t++) {
    if (t < rows) u->set(op, t, a + t * kRow, binary ? b + t * kRow : nullptr, size(t));
    u->clock(op);
    if (t + 1 < lat) continue;
    const uint64_t row = t + 1 - lat;
    u->get(op, row, r + row * kRow, flags == nullptr ? nullptr : flags + row * kRow, size(row));
  }
  return 0;
}

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double measure(cde_fp_unit* u, uint32_t op, uint64_t cycles) {
  if (!present(op)) return -1.0;
  constexpr unsigned kRows = 16;
  struct Row {
    std::array<Container, kLanes> a;
    std::array<Container, kBLanes> b;
    std::array<uint64_t, kLanes> n;
  };
  const auto rows = std::make_unique<std::array<Row, kRows>>();
  std::mt19937_64 random(1);
  constexpr uint64_t kBias = (1u << (kExp - 1)) - 1, kFraction = (uint64_t{1} << kMan) - 1;
  const auto number = [&] {
    return Container(((kBias - 1 + random() % 3) << kMan) | (random() & kFraction));
  };
  for (Row& row : *rows) {
    for (Container& x : row.a) x = number();
    for (Container& x : row.b) x = number();
    for (uint64_t& x : row.n) x = random() >> (random() % 64);
  }
  const double start = processor_seconds();
  for (uint64_t i = 0; i < cycles; i++) {
    const Row& row = (*rows)[i % kRows];
    if (integer_operand(op)) {
      std::memcpy(u->n, row.n.data(), sizeof(row.n));
    } else {
      std::memcpy(u->a, row.a.data(), sizeof(row.a));
      std::memcpy(u->b, row.b.data(), sizeof(row.b));
    }
    u->clock(op);
  }
  return processor_seconds() - start;
}

constexpr cde_fp_api kApi{{CDE_FP_ABI, sizeof(cde_fp_api)},
                          kExp,
                          kMan,
                          kLanes,
                          parameter("FLAGS", 1) != 0,
                          kOps,
                          kParameters,
                          create,
                          destroy,
                          latency,
                          apply,
                          measure};

}  // namespace

extern "C" __attribute__((visibility("default"))) const cde_fp_api* cde_fp_entry() {
  return &kApi;
}
