// card.hpp is rtl/cde_pkg.sv in C++: every localparam there has its constant here, with the same
// value.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <string>

#include "cde/card.hpp"
#include "cde/length_range.hpp"
#include "cde/pair.hpp"
#include "cde/pci.hpp"

namespace cde {
namespace {

/// 12'h0C0, 3'd4, 7 as SystemVerilog writes them.
std::uint64_t value_of(const std::string& text) {
  static const std::regex form(R"((?:\d+'([hd]))?([0-9a-fA-F]+))");
  std::smatch match;
  if (!std::regex_match(text, match, form)) throw std::runtime_error("not a number: " + text);
  return std::stoull(match[2], nullptr, match[1] == "h" ? 16 : 10);
}

std::map<std::string, std::uint64_t> localparams() {
  std::ifstream in(CDE_PACKAGE_SV);
  static const std::regex form(
      R"(^\s*localparam\s+\S+(?:\s*\[[^\]]*\])?\s+(\w+)\s*=\s*([^;]+);.*)");
  std::map<std::string, std::uint64_t> found;
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, form)) {
      found[match[1]] = value_of(match[2]);
    } else if (line.find("localparam") != std::string::npos) {
      ADD_FAILURE() << "unread line of cde_pkg.sv: " << line;
    }
  }
  return found;
}

/// "ray-triangle" as the package writes it: RAY_TRIANGLE.
std::string upper(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
  return text;
}

/// The PCI side, in pci.hpp.
std::map<std::string, std::uint64_t> pci_constants() {
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

TEST(CardLayout, EqualsThePackage) {
  using namespace card;
  std::map<std::string, std::uint64_t> here = {
      {"SPACE_REG", kSpaceReg},
      {"SPACE_PRIM", kSpacePrim},
      {"SPACE_DDR", kSpaceDdr},
      {"SPACE_SRAM", kSpaceSram},
      {"REG_ID", kRegId},
      {"REG_CAPS", kRegCaps},
      {"REG_CONFIG_HASH", kRegConfigHash},
      {"REG_CAPS2", kRegCaps2},
      {"REG_CAPACITY", kRegCapacity},
      {"REG_CONTROL", kRegControl},
      {"REG_PRIM_SPLIT", kRegPrimSplit},
      {"REG_BUDGET", kRegBudget},
      {"NO_PAIR", kNoPair},
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
      {"REG_ECC", kRegEcc},
      {"REG_CAPS3", kRegCaps3},
      {"REG_OBJECT_COUNT", kRegObjectCount},
      {"REG_PRIM_OBJECT_COUNT", kRegPrimObjectCount},
      {"OBJECT_TABLE", kObjectTable},
      {"PRIM_OBJECT_TABLE", kPrimObjectTable},
      {"OBJECT_WORDS", kObjectWords},
      {"OBJECT_FIRST", kObjectFirst},
      {"OBJECT_COUNT", kObjectCount},
      {"OBJECT_ROTATION", kObjectRotation},
      {"OBJECT_TRANSLATION", kObjectTranslation},
      {"OBJECT_END", kObjectEnd},
      {"TRANSFORM_NONE", kTransformNone},
      {"TRANSFORM_SECONDARIES", kTransformSecondaries},
      {"TRANSFORM_BOTH", kTransformBoth},
      {"ID_MAGIC", kIdMagic},
      {"INTERFACE_VERSION", kInterfaceVersion},
      {"STATUS_BUSY", kStatusBusy},
      {"STATUS_DONE", kStatusDone},
      {"STATUS_COMMAND_ERROR", kStatusCommandError},
      {"STATUS_BUS_ERROR", kStatusBusError},
      {"STATUS_SRAM_WAIT", kStatusSramWait},
      {"STATUS_IRQ", kStatusIrq},
      {"STATUS_ECC_ERROR", kStatusEccError},
      {"MODE_NEAREST", kModeNearest},
      {"MODE_FARTHEST", kModeFarthest},
      {"MODE_ANY", kModeAny},
      {"MODE_ALL", kModeAll},
      {"MODE_HITS", kModeHits},
      {"PAIRS", kPairs},
      {"DDR_WORDS", kDdrWords},
      {"RECORD_WORDS", kRecordWords},
      {"RECORD_CP", kRecordCp},
      {"RECORD_FLAGS", kRecordFlags},
      {"RECORD_INDEX", kRecordIndex},
      {"RECORD_T", kRecordT},
      {"RECORD_PRIMARY", kRecordPrimary},
      {"FLAG_F", kFlagF},
      {"FLAG_BAD", kFlagBad},
      {"FLAG_NORMAL", kFlagNormal},
  };
  for (unsigned p = 0; p < kPairs; ++p) here["PAIR_" + upper(name(static_cast<Pair>(p)))] = p;
  for (unsigned a = 0; a < 4; ++a) here["ALGORITHM_" + upper(name(static_cast<Algorithm>(a)))] = a;
  for (unsigned k = 0; k < 7; ++k) here["SHAPE_" + upper(name(static_cast<Shape>(k)))] = k;
  for (const auto& [kind, value] : {std::pair{"COORDINATE", WordKind::kCoordinate},
                                    {"SIZE", WordKind::kSize},
                                    {"DIRECTION", WordKind::kDirection},
                                    {"INTERVAL", WordKind::kInterval},
                                    {"PURE", WordKind::kPure}})
    here["WORD_" + std::string(kind)] = static_cast<unsigned>(value);
  here.merge(pci_constants());
  const auto package = localparams();
  for (const auto& [name, value] : package) {
    const auto found = here.find(name);
    if (found == here.end()) {
      ADD_FAILURE() << name << " of cde_pkg.sv has no constant in card.hpp";
    } else {
      EXPECT_EQ(found->second, value) << name;
    }
  }
  for (const auto& [name, value] : here) {
    EXPECT_TRUE(package.contains(name)) << name << " = " << value << " is not in cde_pkg.sv";
  }
}

}  // namespace
}  // namespace cde
