// SPDX-License-Identifier: Apache-2.0
// rtl/contract and host/include/cde/contract are the same: Verilator says what every constant,
// every field and every function of the packages is, and each must have its like in C++, and none
// more.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cde/contract/formats.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/contract/pci.hpp"
#include "cde/contract/records.hpp"
#include "cde/contract/registers.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/geometry/pair.hpp"
#include "cde/reference/pipes/scale.hpp"

namespace cde {
namespace {

namespace fs = std::filesystem;
using Values = std::map<std::string, std::uint64_t>;
using Fields = std::map<std::string, Field>;

/// "ray-triangle" as packages write it: RAY_TRIANGLE.
std::string upper(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
  return text;
}
std::uint64_t number(auto value) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
}

// ---- The constants in C++, by the names of the packages ----

Values formats() {
  Values v = {{"LEAST_WORDS", 0},
              {"FP_OPS", kFpOps},
              {"FP_ARITHMETIC", kFpArithmetic},
              {"FORMATS", kFpFormats.size()}};
  constexpr const char* kOps[] = {"ADD", "SUB", "MUL", "DIV", "SQRT",
                                  "LT",  "LE",  "EQ",  "MIN", "MAX"};
  for (unsigned k = 0; k < kFpArithmetic; ++k) v["FP_" + std::string(kOps[k])] = k;
  const auto op = [&](const char* name, FpOp code) { v["FP_" + std::string(name)] = number(code); };
  op("TO_FORMAT", FpOp::kToFp16);
  op("FROM_I32", FpOp::kFromI32), op("FROM_UI32", FpOp::kFromUi32);
  op("FROM_I64", FpOp::kFromI64), op("FROM_UI64", FpOp::kFromUi64);
  op("TO_I32", FpOp::kToI32), op("TO_UI32", FpOp::kToUi32);
  op("TO_I64", FpOp::kToI64), op("TO_UI64", FpOp::kToUi64);
  op("TO_I32_TRUNC", FpOp::kToI32Trunc), op("TO_UI32_TRUNC", FpOp::kToUi32Trunc);
  op("TO_I64_TRUNC", FpOp::kToI64Trunc), op("TO_UI64_TRUNC", FpOp::kToUi64Trunc);
  using namespace contract;
  v.merge(Values{{"CONVERT_FORMAT", number(Convert::kFormat)},
                 {"CONVERT_FROM_INT", number(Convert::kFromInt)},
                 {"CONVERT_TO_INT", number(Convert::kToInt)},
                 {"SIGN_ABS", number(Sign::kAbs)},
                 {"SIGN_NEG", number(Sign::kNeg)},
                 {"SIGN_COPY", number(Sign::kCopy)},
                 {"SIGN_XOR", number(Sign::kXor)},
                 {"CLASS_FINITE", number(Class::kFinite)},
                 {"CLASS_NAN", number(Class::kNan)},
                 {"CLASS_POSITIVE", number(Class::kPositive)},
                 {"CLASS_NONZERO", number(Class::kNonzero)},
                 {"EXPONENT_MAX", number(Exponent::kMax)},
                 {"EXPONENT_DOWN", number(Exponent::kDown)},
                 {"EXPONENT_UP", number(Exponent::kUp)},
                 {"EXPONENT_MOVE", number(Exponent::kMove)},
                 {"WIRE_SIGN", number(Wire::kSign)},
                 {"WIRE_AND", number(Wire::kAnd)},
                 {"WIRE_OR", number(Wire::kOr)},
                 {"WIRE_XOR", number(Wire::kXor)}});
  constexpr std::pair<const char*, unsigned> kFlags[] = {{"INEXACT", kFpInexact},
                                                         {"UNDERFLOW", kFpUnderflow},
                                                         {"OVERFLOW", kFpOverflow},
                                                         {"DIVIDE_BY_ZERO", kFpDivideByZero},
                                                         {"INVALID", kFpInvalid}};
  for (const auto& [name, mask] : kFlags)
    v["FLAG_" + std::string(name)] = number(std::countr_zero(mask));
  for (std::size_t k = 0; k < kFpFormats.size(); ++k)
    v["FORMAT_" + upper(kFpFormats.at(k).name)] = k;
  return v;
}

Values pairs() {
  using namespace contract;
  Values v = {{"SHAPES", kShapes},
              {"SHAPE_MOST_WORDS", kMostWords},
              {"PAIRS", kPairs},
              {"SHAPE_BITS", kShapeBits},
              {"SHAPE_CODES", kShapeCodes},
              {"WORDS_BITS", kWordsBits},
              {"PAIR_BITS", kPairBits},
              {"NO_PAIR", kNoPair},
              {"PAIR_CODES", kPairCodes},
              {"PAIR_INDEX", std::bit_width(kPairs - 1)},
              {"PAIR_PLACES", std::bit_ceil(kPairs + 1)},
              {"SHAPE_PLACES", std::bit_ceil(kShapes)},
              {"SHAPE_INDEX", std::bit_width(kShapes - 1)},
              {"SET_EVERYTHING", kSetEverything},
              {"SET_RAYS", kSetRays},
              {"SET_SOLIDS", kSetSolids},
              {"SET_SPHERES", kSetSpheres},
              {"RING_ROWS", kRingRows},
              {"RING_PAIRS", kRingPairs},
              {"FACET_PAIRS", kFacetPairs},
              {"BOX_PAIRS", kBoxPairs},
              {"SHORT_PAIRS", kShortPairs},
              {"SCALED_PAIRS", kScaledPairs},
              {"ALGORITHMS", kAlgorithms},
              {"TRANSFORM_NONE", kTransformNone},
              {"TRANSFORM_SECONDARIES", kTransformSecondaries},
              {"TRANSFORM_BOTH", kTransformBoth},
              {"WORD_COORDINATE", number(WordKind::kCoordinate)},
              {"WORD_SIZE", number(WordKind::kSize)},
              {"WORD_DIRECTION", number(WordKind::kDirection)},
              {"WORD_INTERVAL", number(WordKind::kInterval)},
              {"WORD_PURE", number(WordKind::kPure)},
              {"WORD_NONE", number(WordKind::kNone)}};
  for (unsigned p = 0; p < kPairs; ++p) v["PAIR_" + upper(name(static_cast<Pair>(p)))] = p;
  for (unsigned a = 0; a < kAlgorithms; ++a)
    v["ALGORITHM_" + upper(name(static_cast<Algorithm>(a)))] = a;
  for (unsigned k = 0; k < kShapes; ++k) v["SHAPE_" + upper(name(static_cast<Shape>(k)))] = k;
  return v;
}

Values records() {
  using namespace card;
  return {{"DDR_WORDS", kDdrWords},
          {"MOST_PRIMARIES", kMostPrimaries},
          {"RECORD_WORDS", kRecordWords},
          {"RECORD_CP", kRecordCp},
          {"RECORD_FLAGS", kRecordFlags},
          {"RECORD_INDEX", kRecordIndex},
          {"RECORD_T", kRecordT},
          {"RECORD_PRIMARY", kRecordPrimary},
          {"OBJECT_WORDS", kObjectWords},
          {"OBJECT_FIRST", kObjectFirst},
          {"OBJECT_COUNT", kObjectCount},
          {"OBJECT_ROTATION", kObjectRotation},
          {"OBJECT_TRANSLATION", kObjectTranslation},
          {"OBJECT_END", kObjectEnd}};
}

Values registers() {
  using namespace card;
  return {
      {"SPACE_REG", kSpaceReg},
      {"SPACE_PRIM", kSpacePrim},
      {"SPACE_DDR", kSpaceDdr},
      {"SPACE_SRAM", kSpaceSram},
      {"SPACE_NODES", kSpaceNodes},
      {"SPACE_SLOTS", kSpaceSlots},
      {"SPACE_RAYS", kSpaceRays},
      {"REG_ID", kRegId},
      {"REG_CAPS", kRegCaps},
      {"REG_CONFIG_HASH", kRegConfigHash},
      {"REG_CAPS2", kRegCaps2},
      {"REG_CAPACITY", kRegCapacity},
      {"REG_CONTROL", kRegControl},
      {"REG_PRIM_SPLIT", kRegPrimSplit},
      {"REG_BUDGET", kRegBudget},
      {"REG_STATUS", kRegStatus},
      {"REG_COMMAND", kRegCommand},
      {"REG_PRIM_COUNT", kRegPrimCount},
      {"REG_SEC_FIRST", kRegSecFirst},
      {"REG_SEC_COUNT", kRegSecCount},
      {"REG_RECORDS", kRegRecords},
      {"REG_FAULT_ADDR", kRegFaultAddr},
      {"REG_WRITEBACK", kRegWriteback},
      {"REG_STENCIL", kRegStencil},
      {"REG_CYCLES", kRegCycles},
      {"REG_ROWS", kRegRows},
      {"REG_STALLS", kRegStalls},
      {"REG_BUBBLES", kRegBubbles},
      {"REG_BAD_PRIM", kRegBadPrim},
      {"REG_BAD_SEC", kRegBadSec},
      {"REG_SECONDARIES", kRegSecondaries},
      {"REG_WRITTEN", kRegWritten},
      {"REG_OPEN", kRegOpen},
      {"REG_NODES", kRegNodes},
      {"REG_LEAVES", kRegLeaves},
      {"REG_TESTED", kRegTested},
      {"REG_ROOT", kRegRoot},
      {"REG_NODE_CAPS", kRegNodeCaps},
      {"REG_NODE_COUNT", kRegNodeCount},
      {"REG_RAY_COUNT", kRegRayCount},
      {"REG_RAYS", kRegRays},
      {"REG_DEEPEST", kRegDeepest},
      {"REG_NODE_FAULT", kRegNodeFault},
      {"REG_NEW_ROOT", kRegNewRoot},
      {"REG_NODE_FLIP", kRegNodeFlip},
      {"REG_SLOT_COUNT", kRegSlotCount},
      {"REG_NODE_FIRST", kRegNodeFirst},
      {"NODE_FAULT_NODE", kNodeFaultNode},
      {"NODE_FAULT_SLOT", kNodeFaultSlot},
      {"NODE_FAULT_INDEX", kNodeFaultIndex},
      {"NODE_FAULT_DEPTH", kNodeFaultDepth},
      {"NODE_FAULT_ENDLESS", kNodeFaultEndless},
      {"NODE_FAULT_SECONDARY", kNodeFaultSecondary},
      {"NODE_FAULT_NODE_BITS", kNodeFaultNodeBits},
      {"NODE_FAULT_SLOT_BITS", kNodeFaultSlotBits},
      {"NODE_FAULT_OBJECT", kNodeFaultObject},
      {"REG_ECC", kRegEcc},
      {"REG_CAPS3", kRegCaps3},
      {"REG_PAIRS", kRegPairs},
      {"REG_OBJECT_COUNT", kRegObjectCount},
      {"REG_PRIM_OBJECT_COUNT", kRegPrimObjectCount},
      {"OBJECT_TABLE", kObjectTable},
      {"PRIM_OBJECT_TABLE", kPrimObjectTable},
      {"ID_MAGIC", kIdMagic},
      {"INTERFACE_VERSION", kInterfaceVersion},
      {"MODE_NEAREST", kModeNearest},
      {"MODE_FARTHEST", kModeFarthest},
      {"MODE_ANY", kModeAny},
      {"MODE_ALL", kModeAll},
      {"MODE_HITS", kModeHits},
      {"MODE_OCCLUDED", kModeOccluded},
      {"MODE_REFIT", kModeRefit},
      {"SPACES", kSpaces},
      {"SPACE_BITS", kSpaceBits},
      {"COUNTERS", kCounters},
      {"ENGINE_COUNTERS", kEngineCounters},
      {"REG_END", kRegEnd},
      {"COMMAND_BITS", kCommandBits},
      {"BUDGET_RESET", kBudgetReset},
      {"BUDGET_MOST", kBudgetMost},
  };
}

Values pci_side() {
  using namespace pci;
  return {
      {"PCI_VENDOR_ID", kVendorId},
      {"PCI_DEVICE_ID", kDeviceId},
      {"PCI_CLASS", kClass},
      {"PCI_SUBSYSTEM", kSubsystem},
      {"PCI_BAR_BITS", kBarBits},
      {"PCI_REGISTERS", kRegisters},
      {"PCI_REGISTERS_END", kRegistersEnd},
      {"PCI_PAGE_TABLE", kPageTable},
      {"PCI_PAGES", kPages},
      {"PCI_PAGE_BITS", kPageBits},
      {"PCI_PAGE_VALID", kPageValid},
      {"PCI_PAGE_WRITABLE", kPageWritable},
      {"PCI_PAGE_FRAME", kPageFrame},
      {"PCI_MEMORY_READ", kMemoryRead},
      {"PCI_MEMORY_WRITE", kMemoryWrite},
      {"PCI_CONFIG_READ", kConfigRead},
      {"PCI_CONFIG_WRITE", kConfigWrite},
      {"PCI_READ_MULTIPLE", kReadMultiple},
      {"PCI_READ_LINE", kReadLine},
      {"PCI_WRITE_INVALIDATE", kWriteInvalidate},
      {"PCI_REG_CONTROL", kRegControl},
      {"PCI_REG_STATUS", kRegStatus},
      {"PCI_REG_IRQ_STATUS", kRegIrqStatus},
      {"PCI_REG_IRQ_MASK", kRegIrqMask},
      {"PCI_REG_RING_BASE", kRegRingBase},
      {"PCI_REG_RING_SIZE", kRegRingSize},
      {"PCI_REG_RING_HEAD", kRegRingHead},
      {"PCI_REG_RING_TAIL", kRegRingTail},
      {"PCI_REG_COMPLETION_BASE", kRegCompletionBase},
      {"PCI_REG_BURST", kRegBurst},
      {"PCI_REG_RETRY_LIMIT", kRegRetryLimit},
      {"PCI_REG_FAULT_ADDR", kRegFaultAddr},
      {"PCI_REG_BURSTS", kRegBursts},
      {"PCI_REG_BEATS", kRegBeats},
      {"PCI_REG_WAITS", kRegWaits},
      {"PCI_REG_RETRIES", kRegRetries},
      {"PCI_REG_DISCONNECTS", kRegDisconnects},
      {"PCI_REG_PARITY_ERRORS", kRegParityErrors},
      {"PCI_REG_ABORTS", kRegAborts},
      {"PCI_REG_BUSY", kRegBusy},
      {"PCI_CONTROL_RUN", kControlRun},
      {"PCI_CONTROL_STOP", kControlStop},
      {"PCI_CONTROL_CLEAR", kControlClear},
      {"PCI_CONTROL_COUNT", kControlCount},
      {"PCI_STATUS_RUN", kStatusRun},
      {"PCI_STATUS_HALTED", kStatusHalted},
      {"PCI_STATUS_BUSY", kStatusBusy},
      {"PCI_STATUS_CLEARING", kStatusClearing},
      {"PCI_STATUS_CODE", kStatusCode},
      {"PCI_STATUS_WHERE", kStatusWhere},
      {"PCI_IRQ_COMPLETION", kIrqCompletion},
      {"PCI_IRQ_HALTED", kIrqHalted},
      {"PCI_IRQ_CARD", kIrqCard},
      {"PCI_DESCRIPTOR_BYTES", kDescriptorBytes},
      {"PCI_DESCRIPTOR_SPACE", kDescriptorSpace},
      {"PCI_DESCRIPTOR_TO_HOST", kDescriptorToHost},
      {"PCI_DESCRIPTOR_IRQ", kDescriptorIrq},
      {"PCI_COMPLETION_BYTES", kCompletionBytes},
      {"PCI_COMPLETION_NUMBER", kCompletionNumber},
      {"PCI_COMPLETION_PCI", kCompletionPci},
      {"PCI_COMPLETION_CODE", kCompletionCode},
      {"PCI_COMPLETION_LAP", kCompletionLap},
      {"PCI_COMPLETION_LAP_FIRST", 32 + kCompletionLapFirst},
      {"PCI_CODE_OK", kCodeOk},
      {"PCI_CODE_LENGTH", kCodeLength},
      {"PCI_CODE_ALIGNMENT", kCodeAlignment},
      {"PCI_CODE_UNMAPPED", kCodeUnmapped},
      {"PCI_CODE_READ_ONLY", kCodeReadOnly},
      {"PCI_CODE_MASTER_ABORT", kCodeMasterAbort},
      {"PCI_CODE_TARGET_ABORT", kCodeTargetAbort},
      {"PCI_CODE_PARITY", kCodeParity},
      {"PCI_CODE_RETRY_LIMIT", kCodeRetryLimit},
      {"PCI_CODE_SETTINGS", kCodeSettings},
      {"PCI_CODE_STOPPED", kCodeStopped},
      {"PCI_CODE_DISABLED", kCodeDisabled},
      {"PCI_WHERE_DATA", kWhereData},
      {"PCI_WHERE_DESCRIPTOR", kWhereDescriptor},
      {"PCI_WHERE_COMPLETION", kWhereCompletion},
      {"PCI_WHERE_SETTINGS", kWhereSettings},
  };
}

/// Fields of the registers and records, by structure and name; those of ports inside the card are
/// its own.
Fields fields() {
  using namespace card;
  const auto bit = [](std::uint64_t mask) {
    return Field{static_cast<unsigned>(std::countr_zero(mask)), 1};
  };
  return {{"id_t.magic", kIdMagicField},
          {"id_t.version", kIdVersion},
          {"caps_t.algorithm", kCapsAlgorithm},
          {"caps_t.man", kCapsMan},
          {"caps_t.exp", kCapsExp},
          {"caps_t.primaries", kCapsPrimaries},
          {"caps_t.lanes", kCapsLanes},
          {"caps2_t.node_units", kCaps2NodeUnits},
          {"caps2_t.container", kCaps2Container},
          {"caps2_t.sram_records", kCaps2SramRecords},
          {"caps2_t.latency", kCaps2Latency},
          {"caps3_t.prim_objects", kCaps3PrimObjects},
          {"caps3_t.objects", kCaps3Objects},
          {"caps3_t.prim_words", kCaps3PrimWords},
          {"caps3_t.verdicts", kCaps3Verdicts},
          {"caps3_t.box", kCaps3Box},
          {"caps3_t.ecc", kCaps3Ecc},
          {"caps3_t.transform", kCaps3Transform},
          {"caps3_t.parallel", kCaps3Parallel},
          {"caps3_t.normals", kCaps3Normals},
          {"caps3_t.swap", kCaps3Swap},
          {"control_t.clear", bit(kControlClear)},
          {"control_t.stop", bit(kControlAbort)},
          {"control_t.go", bit(kControlGo)},
          {"status_t.busy", {kStatusBusy}},
          {"status_t.done", {kStatusDone}},
          {"status_t.command_error", {kStatusCommandError}},
          {"status_t.bus_error", {kStatusBusError}},
          {"status_t.sram_wait", {kStatusSramWait}},
          {"status_t.irq", {kStatusIrq}},
          {"status_t.ecc_error", {kStatusEccError}},
          {"status_t.node_error", {kStatusNodeError}},
          {"node_caps_t.slots_a_node", kNodeCapsSlotsANode},
          {"node_caps_t.rays", kNodeCapsRays},
          {"node_caps_t.nodes", kNodeCapsNodes},
          {"rays_t.taken", kRaysTaken},
          {"rays_t.provided", kRaysProvided},
          {"node_fault_t.kind", kNodeFaultKind},
          {"node_fault_t.place", kNodeFaultPlace},
          {"node_flip_t.word", kNodeFlipWord},
          {"node_flip_t.bits", kNodeFlipBits},
          {"command_t.second_pair", kCommandSecondPair},
          {"command_t.second_swap", bit(kCommandSecondSwap)},
          {"command_t.second", bit(kCommandSecond)},
          {"command_t.pair", kCommandPair},
          {"command_t.hierarchy", bit(kCommandHierarchy)},
          {"command_t.normals", bit(kCommandNormals)},
          {"command_t.swap", bit(kCommandSwap)},
          {"command_t.mode", kCommandMode},
          {"budget_t.k2", kBudgetK2},
          {"budget_t.k1", kBudgetK1},
          {"budget_t.m", kBudgetM},
          {"fault_t.space", kFaultSpace},
          {"fault_t.addr", kFaultAddr},
          {"ecc_t.failed", kEccFailed},
          {"ecc_t.corrected", kEccCorrected},
          {"record_flags_t.normal", {kFlagNormal}},
          {"record_flags_t.bad", {kFlagBad}},
          {"record_flags_t.f", {kFlagF}}};
}

// ---- The packages ----

/// Types of codes, and how many bits they have.
const std::map<std::string, unsigned> kCodes = {
    {"shape_t", kShapeBits}, {"pair_t", kPairBits}, {"words_t", kWordsBits}};

struct Package {
  std::set<std::string> constants, functions;
  Fields fields;
  std::map<std::string, unsigned> bits;  ///< of each structure
  std::set<std::string> codes;           ///< types that are vectors
};

Package read_package(const fs::path& file) {
  std::ifstream in(file);
  static const std::regex constant(R"(^\s*localparam\s+(?:\w+\s+)+?(?:\[[^\]]*\]\s*)?(\w+)\s*=.*)");
  static const std::regex function(R"(^\s*function automatic .*?(\w+)\(.*)");
  static const std::regex field(R"(^\s*logic\s+(?:\[(\d+):0\]\s+)?(\w+);.*)");
  static const std::regex code(R"(^\s*typedef logic \[\d+:0\] (\w+);.*)");
  static const std::regex code_field(R"(^\s*pairs_pkg::(\w+)\s+(\w+);.*)");
  static const std::regex end(R"(^\s*\}\s*(\w+);.*)");
  Package package;
  std::vector<std::pair<std::string, unsigned>> open;  // fields, from the top
  for (std::string line; std::getline(in, line);) {
    std::smatch m;
    if (std::regex_match(line, m, constant)) {
      package.constants.insert(m[1]);
    } else if (line.find("localparam") != std::string::npos) {
      ADD_FAILURE() << file << ": unread line: " << line;
    } else if (std::regex_match(line, m, function)) {
      package.functions.insert(m[1]);
    } else if (line.find("typedef struct packed") != std::string::npos) {
      open.clear();
    } else if (std::regex_match(line, m, code)) {
      package.codes.insert(m[1]);
    } else if (std::regex_match(line, m, code_field)) {
      open.emplace_back(m[2], kCodes.at(m[1]));
    } else if (std::regex_match(line, m, field)) {
      open.emplace_back(m[2], m[1].matched ? static_cast<unsigned>(std::stoul(m[1])) + 1 : 1);
    } else if (std::regex_match(line, m, end)) {
      unsigned low = 0;
      for (auto f = open.rbegin(); f != open.rend(); low += f->second, ++f)
        if (f->first.rfind("reserved", 0) != 0)
          package.fields[m[1].str() + "." + f->first] = {low, f->second};
      package.bits[m[1]] = low;
    } else if (line.find("typedef") != std::string::npos) {
      ADD_FAILURE() << file << ": unread line: " << line;
    }
  }
  return package;
}

/// Expressions of SystemVerilog and what they must be; Verilator evaluates all at once.
class Probe {
 public:
  void expect(const std::string& expression, std::uint64_t value) {
    expected_.emplace_back(expression, value);
  }
  void run(const fs::path& contract, const std::vector<std::string>& packages) const {
    std::string folder = (fs::temp_directory_path() / "cde-contract-XXXXXX").string();
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    const fs::path work(folder);
    std::ofstream out(work / "contract_probe.sv");
    out << "module contract_probe;\n";
    for (std::size_t i = 0; i < expected_.size(); ++i)
      out << "  $info(\"@" << i << " %0h\", 64'(" << expected_[i].first << "));\n";
    out << "endmodule\n";
    out.close();
    std::string command =
        "cd '" + folder + "' && verilator --lint-only -Wno-fatal -I'" + contract.string() + "'";
    for (const std::string& package : packages)
      command += " '" + (contract / package).string() + "'";
    command += " contract_probe.sv >said 2>&1";
    const int status = std::system(command.c_str());
    std::stringstream said;
    said << std::ifstream(work / "said").rdbuf();
    fs::remove_all(work);
    ASSERT_EQ(status, 0) << said.str();
    std::set<std::size_t> seen;
    static const std::regex form(R"(.*: @(\d+) ([0-9a-f]+)$)");
    for (std::string line; std::getline(said, line);) {
      std::smatch m;
      if (!std::regex_match(line, m, form)) continue;
      const auto& [expression, value] = expected_.at(std::stoul(m[1]));
      EXPECT_EQ(std::stoull(m[2], nullptr, 16), value) << expression;
      seen.insert(std::stoul(m[1]));
    }
    EXPECT_EQ(seen.size(), expected_.size()) << "Verilator did not say what all of them are";
  }

 private:
  std::vector<std::pair<std::string, std::uint64_t>> expected_;
};

/// Calls of a function; the test knows which have been made.
class Calls {
 public:
  Calls(Probe& probe, std::string package) : probe_(probe), package_(std::move(package)) {}
  void operator()(const std::string& function, const std::vector<int>& arguments, auto value) {
    std::string call = package_ + "::" + function + "(";
    for (const int& a : arguments)
      call.append(arguments.data() == &a ? "" : ", ").append(std::to_string(a));
    probe_.expect(call + ")", number(value));
    called_.insert(function);
  }
  [[nodiscard]] const std::set<std::string>& called() const { return called_; }

 private:
  Probe& probe_;
  std::string package_;
  std::set<std::string> called_;
};

/// Words of a lane of gates, which software does not know.
void lane_functions(Calls& call, int exp, int man) {
  const int word = 1 + exp + man <= 32 && man <= 23 ? 32 : 64;
  int bits = 1;  // that hold the largest exponent of a quotient and its sign
  while ((1 << (bits - 1)) < 3 * (1 << (exp - 1)) + 2 * man + 4) ++bits;
  call("lane_word", {exp, man, 0}, word);
  call("lane_word", {exp, man, 1}, man + std::max(1 + exp, 6));
  call("lane_exponent", {exp, man, 0}, word);
  call("lane_exponent", {exp, man, 1}, bits);
  call("round_top", {exp, man, 0}, word - 1);
  call("round_top", {exp, man, 1}, man + 3);
}

/// Cuts of a lane spread over its places: the first k places have the share of k that is nearest.
void cut_functions(Calls& call) {
  for (const int places : {1, 8, 31})
    for (const int cuts : {0, 1, places / 2, places}) {
      int before = 0;
      for (int place = 0; place < places; ++place) {
        const int share = ((place + 1) * cuts + places / 2) / places;
        call("cuts_at", {cuts, places, place}, share - before);
        before = share;
      }
    }
}

void format_functions(Calls& call) {
  cut_functions(call);
  for (std::size_t k = 0; k < kFpFormats.size(); ++k) {
    call("format_exp", {static_cast<int>(k)}, kFpFormats.at(k).format.exp_bits);
    call("format_man", {static_cast<int>(k)}, kFpFormats.at(k).format.man_bits);
  }
  for (int exp = 3; exp <= 11; ++exp) {
    call("length_high", {exp}, LengthRange::of(exp, 2).high);
    for (const int man : {2, 3, 7, 10, 16, 20, 23, 24, 52}) {
      const FpFormat format{exp, man};
      lane_functions(call, exp, man);
      call("container", {exp, man}, contract::container(exp, man));
      call("infinity", {exp, man}, format.infinity());
      call("quiet_nan", {exp, man}, format.canonical_nan());
      call("sign_bit", {exp, man}, format.sign_bit());
      call("length_low", {exp, man}, LengthRange::of(exp, man).low);
      for (const int e : {-40, -3, -1, 0, 1, 2})
        if (e <= format.bias())
          call("power_of_two", {exp, man, e},
               e < format.emin() - man ? 0 : format.encode(std::ldexp(1.0, e)));
    }
  }
  call("larger", {3, 4}, 4);
  call("larger", {4, -3}, 4);
}

void shape_functions(Calls& call) {
  for (int s = 0; s < static_cast<int>(kShapes); ++s) {
    const auto shape = static_cast<Shape>(s);
    int lengths = 0;
    call("shape_words", {s}, words(shape));
    for (int k = 0; k < static_cast<int>(contract::kMostWords); ++k) {
      const WordKind kind = contract::word_kind(shape, static_cast<std::size_t>(k));
      call("word_kind", {s, k}, kind);
      call("is_length", {s, k}, reference::scaling::is_length(kind));
      if (reference::scaling::is_length(kind)) call("length_word", {s, lengths++}, k);
    }
    call("lengths", {s}, lengths);
  }
}

void pair_functions(Calls& call) {
  for (int p = 0; p < static_cast<int>(kPairs); ++p) {
    const auto pair = static_cast<Pair>(p);
    const Shape a = primary_shape(pair), b = secondary_shape(pair);
    call("primary_shape", {p}, a);
    call("secondary_shape", {p}, b);
    call("primary_words", {p}, words(a));
    call("secondary_words", {p}, words(b));
    if (has_budget(pair))
      call("cylinder_body", {p}, a == Shape::kCylinder ? 0 : a == Shape::kObb ? 1 : 2);
    for (const int exp : {3, 7, 8, 11}) call("scaled", {p, exp}, reference::is_scaled(a, b, exp));
  }
}

/// Sets of one pair, of two and of all.
void set_functions(Calls& call) {
  const auto shapes_of = [](int set, bool primary, bool swap) {
    std::set<Shape> shapes;
    for (unsigned p = 0; p < kPairs; ++p) {
      if ((set >> p & 1) == 0) continue;
      if (primary || swap) shapes.insert(primary_shape(static_cast<Pair>(p)));
      if (!primary || swap) shapes.insert(secondary_shape(static_cast<Pair>(p)));
    }
    return shapes;
  };
  std::vector<int> sets = {(1 << kPairs) - 1};
  for (unsigned p = 0; p < kPairs; ++p) sets.insert(sets.end(), {1 << p, 1 << p | 16});
  for (const int set : sets) {
    for (int p = 0; p < static_cast<int>(kPairCodes); ++p)
      call("has", {set, p}, std::int64_t{set} >> p & 1);
    for (const int swap : {0, 1}) {
      for (const int primary : {0, 1}) {
        const std::set<Shape> shapes = shapes_of(set, primary != 0, swap != 0);
        unsigned most = 0;
        for (const Shape shape : shapes) most = std::max(most, words(shape));
        call("slot_words", {set, primary, swap}, most);
        for (int s = 0; s < static_cast<int>(kShapes); ++s)
          call("uses_shape", {set, s, primary, swap}, shapes.contains(static_cast<Shape>(s)));
      }
      for (const unsigned transform : {kTransformSecondaries, kTransformBoth}) {
        const auto t = static_cast<int>(transform);
        std::set<Shape> moved = shapes_of(set, false, swap != 0);
        if (transform == kTransformBoth) moved.merge(shapes_of(set, true, swap != 0));
        for (int s = 0; s < static_cast<int>(kShapes); ++s)
          call("moves_shape", {set, s, swap, t}, moved.contains(static_cast<Shape>(s)));
        call("transform_latency", {set, swap, t, 3, 5}, moved.contains(Shape::kPlane) ? 25 : 14);
      }
    }
  }
}

/// Clocks of what stands in front of and behind a scaled pipe: tests/pipes measures them.
void time_functions(Calls& call) {
  for (const int mul : {1, 2, 5})
    for (const int compare : {1, 2, 3}) {
      call("unscale_latency", {0, mul, compare}, compare);
      call("unscale_latency", {1, mul, compare}, std::max(mul, compare));
      call("scale_latency", {0, mul, compare}, 2 * compare);
      call("scale_latency", {1, mul, compare}, compare + std::max(mul, compare));
      call("ring_entry", {4, mul, compare}, 2 * compare + std::max(4, mul));
    }
}

TEST(Contract, IsTheSameInBothLanguages) {
  if (std::system("command -v verilator >/dev/null") != 0)
    GTEST_SKIP() << "verilator is not installed: nothing says what the packages hold";
  const fs::path contract(CDE_CONTRACT_FOLDER);
  std::vector<std::string> packages;
  std::ifstream list(contract / "packages.f");
  for (std::string line; std::getline(list, line);) packages.push_back(line);
  const std::map<std::string, Values> here = {{"formats_pkg", formats()},
                                              {"pairs_pkg", pairs()},
                                              {"records_pkg", records()},
                                              {"registers_pkg", registers()},
                                              {"pci_pkg", pci_side()}};
  // Tables, which functions of the packages read.
  const std::map<std::string, std::string> tables = {{"FORMAT_EXPS", "format_exp"},
                                                     {"FORMAT_MANS", "format_man"},
                                                     {"SHAPE_WORDS", "shape_words"},
                                                     {"WORD_KINDS", "word_kind"},
                                                     {"PRIMARY_SHAPES", "primary_shape"},
                                                     {"SECONDARY_SHAPES", "secondary_shape"},
                                                     {"COUNTER_REGISTERS", "counter_register"}};
  // What goes between modules of the card, and no software sees.
  const std::set<std::string> inside = {"bus_request_t", "bus_response_t"};
  Probe probe;
  Fields known = fields();
  std::size_t constants = 0;
  for (const std::string& file : packages) {
    const std::string name = file.substr(0, file.find('.'));
    if (!here.contains(name)) continue;  // how modules of the card are joined
    SCOPED_TRACE(file);
    const Package package = read_package(contract / file);
    Calls call(probe, name);
    if (name == "formats_pkg") format_functions(call);
    if (name == "pairs_pkg") {
      shape_functions(call), pair_functions(call), set_functions(call), time_functions(call);
    }
    if (name == "registers_pkg")
      for (int c = 0; c < static_cast<int>(card::kCounters); ++c)
        call("counter_register", {c}, card::kCounterRegisters[c]);
    EXPECT_EQ(call.called(), package.functions);
    Values values = here.at(name);
    for (const std::string& constant : package.constants) {
      if (const auto table = tables.find(constant); table != tables.end()) {
        EXPECT_TRUE(call.called().contains(table->second)) << constant;
        continue;
      }
      EXPECT_TRUE(values.contains(constant))
          << constant << " is not in C++, or not in the lists of this test";
      probe.expect(name + "::" + constant, values[constant]);
      values.erase(constant);
      ++constants;
    }
    for (const auto& [constant, value] : values)
      ADD_FAILURE() << constant << " = " << value << " is not in the package";
    for (const std::string& type : package.codes)
      probe.expect("$bits(" + name + "::" + type + ")", kCodes.at(type));
    for (const auto& [type, bits] : package.bits)
      probe.expect("$bits(" + name + "::" + type + ")", bits);
    for (const auto& [field, place] : package.fields) {
      if (inside.contains(field.substr(0, field.find('.')))) continue;
      EXPECT_TRUE(known.contains(field))
          << field << " is not in C++, or not in the list of this test";
      EXPECT_EQ(known[field], place) << field;
      known.erase(field);
    }
  }
  for (const auto& [field, place] : known) ADD_FAILURE() << field << " is not in the packages";
  EXPECT_GT(constants, 200u);
  probe.run(contract, packages);
}

/// Parameter, structure and what joins them are three lists of one file.
TEST(Contract, EveryParameterOfACardIsAFieldOfItsConfiguration) {
  std::stringstream text;
  text << std::ifstream(fs::path(CDE_CONTRACT_FOLDER) / "config.svh").rdbuf();
  const std::string all = text.str();
  const auto names = [&](const char* macro, const char* end, const char* form) {
    const std::size_t from = all.find(std::string("`define ") + macro);
    const std::string part = all.substr(from, all.find(end, from) - from);
    std::vector<std::string> found;
    const std::regex expression(form);
    for (std::sregex_iterator m(part.begin(), part.end(), expression), none; m != none; ++m)
      found.push_back(upper((*m)[1].str()));
    return found;
  };
  auto parameters = names("CARD_PARAMETERS", "\n\n", R"(parameter (?:int )?(\w+) =)");
  auto values = names("CARD_CONFIG", "}", R"((?:[{ (])([A-Z][A-Z_]+)(?=[,} ]|$))");
  auto fields =
      names("CARD_FIELDS", "`endif", R"((?:int|logic \[63:0\]|latency_pkg::latency_t) (\w+);)");
  ASSERT_GT(parameters.size(), 20u);
  values.erase(values.begin());  // the macro's own name
  parameters.emplace_back("CONFIG_HASH");
  EXPECT_EQ(values, parameters);
  std::replace(parameters.begin(), parameters.end(), std::string("ARITH"), std::string("HOST"));
  // Those of operators are one field, of the type latency_t, in the same order.
  const auto first = std::find(parameters.begin(), parameters.end(), "LAT_ADD");
  ASSERT_GT(parameters.end() - first, 5);
  EXPECT_EQ(std::vector<std::string>(first, first + 5),
            (std::vector<std::string>{"LAT_ADD", "LAT_MUL", "LAT_DIV", "LAT_SQRT", "LAT_CMP"}));
  *first = "LAT";
  parameters.erase(first + 1, first + 5);
  EXPECT_EQ(fields, parameters);
}

}  // namespace
}  // namespace cde
