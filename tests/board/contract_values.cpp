// SPDX-License-Identifier: Apache-2.0
#include "contract_values.hpp"

#include <bit>
#include <cctype>

#include "cde/contract/formats.hpp"
#include "cde/contract/pairs.hpp"
#include "cde/contract/pci.hpp"
#include "cde/contract/records.hpp"
#include "cde/fp/fp_format.hpp"
#include "cde/geometry/length_range.hpp"
#include "cde/geometry/pair.hpp"

namespace cde::contract_values {
namespace {

std::uint64_t number(auto value) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
}

}  // namespace

std::string upper(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
  return text;
}
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
              {"ITERATIVE_ROWS", kIterativeRows},
              {"ITERATIVE_PAIRS", kIterativePairs},
              {"SAT_PAIRS", kSatPairs},
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
      {"REG_ITERATIONS", kRegIterations},
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
      {"REG_UNCERTAIN", kRegUncertain},
      {"REG_NODES", kRegNodes},
      {"REG_LEAVES", kRegLeaves},
      {"REG_TESTED", kRegTested},
      {"REG_CACHED", kRegCached},
      {"REG_FETCHED", kRegFetched},
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
      {"REG_NODE_BASE", kRegNodeBase},
      {"REG_SLOT_BASE", kRegSlotBase},
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
      {"ITERATIONS_RESET", kIterationsReset},
      {"ITERATIONS_MOST", kIterationsMost},
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
          {"caps2_t.traversal_units", kCaps2TraversalUnits},
          {"caps2_t.container", kCaps2Container},
          {"caps2_t.sram_records", kCaps2SramRecords},
          {"caps2_t.latency", kCaps2Latency},
          {"caps3_t.prim_objects", kCaps3PrimObjects},
          {"caps3_t.objects", kCaps3Objects},
          {"caps3_t.prim_words", kCaps3PrimWords},
          {"caps3_t.filter", kCaps3Filter},
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
          {"node_caps_t.pinned_bits", kNodeCapsPinnedBits},
          {"node_caps_t.slots_per_node", kNodeCapsSlotsPerNode},
          {"node_caps_t.rays", kNodeCapsRays},
          {"node_caps_t.nodes", kNodeCapsNodes},
          {"slot_base_t.objects", kSlotBaseObjects},
          {"slot_base_t.slots", kSlotBaseSlots},
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
          {"command_t.bvh", bit(kCommandBvh)},
          {"command_t.normals", bit(kCommandNormals)},
          {"command_t.swap", bit(kCommandSwap)},
          {"command_t.mode", kCommandMode},
          {"iterations_t.k2", kIterationsK2},
          {"iterations_t.k1", kIterationsK1},
          {"iterations_t.m", kIterationsM},
          {"fault_t.space", kFaultSpace},
          {"fault_t.addr", kFaultAddr},
          {"ecc_t.failed", kEccFailed},
          {"ecc_t.corrected", kEccCorrected},
          {"record_flags_t.normal", {kFlagNormal}},
          {"record_flags_t.bad", {kFlagBad}},
          {"record_flags_t.f", {kFlagF}}};
}

}  // namespace cde::contract_values
