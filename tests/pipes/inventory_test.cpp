// The operators of the ray pipes, counted in the elaborated design, against what their mirror
// references state; those of Moeller against the paper's Table 2.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Inventory {
  int multipliers = 0, dividers = 0, roots = 0, adders = 0, subtractors = 0, comparators = 0,
      minima = 0;
  bool operator==(const Inventory&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Inventory& i) {
  return out << i.multipliers << " mul, " << i.dividers << " div, " << i.roots << " sqrt, "
             << i.adders << " add, " << i.subtractors << " sub, " << i.comparators << " cmp, "
             << i.minima << " min/max";
}

/// Elaborates `top` with Verilator and returns its XML.
std::string elaborate(const std::string& top, const std::string& parameters) {
  const fs::path xml = fs::path(::testing::TempDir()) / (top + std::to_string(::getpid()) + ".xml");
  const fs::path rtl = fs::path(CDE_SOURCE_DIR) / "rtl";
  std::ostringstream command;
  command << "verilator --xml-only -Wno-fatal --xml-output " << xml << " -Mdir "
          << ::testing::TempDir() << " --top-module " << top << ' ' << parameters << ' '
          << fs::path(CDE_SOURCE_DIR) / "verilator/waivers.vlt" << ' ' << rtl / "cde_pkg.sv";
  for (const auto& entry : fs::directory_iterator(rtl))
    if (entry.is_directory()) command << " -y " << entry.path() << " -I" << entry.path().string();
  command << ' ' << rtl / "pipes" / (top + ".sv");
  EXPECT_EQ(std::system(command.str().c_str()), 0) << command.str();
  std::ifstream in(xml);
  std::stringstream text;
  text << in.rdbuf();
  fs::remove(xml);
  return text.str();
}

Inventory count(const std::string& xml) {
  // Specialised module name -> what it is.
  std::map<std::string, std::string> kind;
  const std::regex module(R"re(<module [^>]*name="(\w+)" origName="(\w+)")re"),
      sub(R"re(name="SUB"[^>]*>\s*<const [^>]*name="1&apos;h1")re");
  for (std::sregex_iterator it(xml.begin(), xml.end(), module), end; it != end; ++it) {
    const size_t from = static_cast<size_t>(it->position()), to = xml.find("</module>", from);
    std::string what = (*it)[2];
    if (what == "fp_add" &&
        std::regex_search(xml.substr(from, std::min<size_t>(to - from, 6000)), sub))
      what = "fp_sub";
    kind[(*it)[1]] = what;
  }
  std::map<std::string, int> instances;
  const std::regex cell(R"re(<cell [^>]*submodname="(\w+)")re");
  for (std::sregex_iterator it(xml.begin(), xml.end(), cell), end; it != end; ++it)
    ++instances[kind[(*it)[1]]];
  return {instances["fp_mul"], instances["fp_div"], instances["fp_sqrt"],  instances["fp_add"],
          instances["fp_sub"], instances["fp_cmp"], instances["fp_minmax"]};
}

/// The operators that host/include/cde/reference/ states for a pipe, the paper's for Moeller.
/// tests/numerics holds the references against the same figures.
struct Pipe {
  const char* module;
  Inventory stated;
};

const Pipe kMoller{
    "ray_triangle_moller",
    {.multipliers = 27, .dividers = 1, .adders = 12, .subtractors = 15, .comparators = 8}};
const Pipe kPipes[] = {
    kMoller,
    {"ray_triangle_badouel",
     {.multipliers = 22, .dividers = 1, .adders = 10, .subtractors = 14, .comparators = 8}},
    {"ray_triangle_pluecker",
     {.multipliers = 54, .dividers = 1, .adders = 22, .subtractors = 27, .comparators = 6}},
    {"ray_triangle_watertight",
     {.multipliers = 32, .dividers = 3, .adders = 13, .subtractors = 18, .comparators = 8}},
    {"ray_sphere",
     {.multipliers = 22,
      .dividers = 2,
      .roots = 1,
      .adders = 15,
      .subtractors = 5,
      .comparators = 5}},
    {"ray_cylinder",
     {.multipliers = 41,
      .dividers = 3,
      .roots = 1,
      .adders = 16,
      .subtractors = 16,
      .comparators = 11,
      .minima = 2}}};

class PipeInventory : public ::testing::TestWithParam<Pipe> {};

TEST_P(PipeInventory, IsWhatTheReferenceStates) {
  EXPECT_EQ(count(elaborate(GetParam().module, "")), GetParam().stated);
}

INSTANTIATE_TEST_SUITE_P(Rays, PipeInventory, ::testing::ValuesIn(kPipes),
                         [](const auto& info) { return std::string(info.param.module); });

TEST(Inventory, MoreLanesAreTheSameOperatorsWider) {
  EXPECT_EQ(count(elaborate(kMoller.module, "-GLANES=4")), kMoller.stated);
}

TEST(Inventory, CountsWhatIsThere) {
  // A cross product alone: a count that always gave the paper's figures would fail here.
  const std::string xml = elaborate("ray_triangle_moller", "");
  const std::regex cell(
      R"re(<cell [^>]*name="(\w+)" submodname="(\w+)" hier="ray_triangle_moller\.cross_p\.[\w.]+")re");
  std::map<std::string, int> names;
  for (std::sregex_iterator it(xml.begin(), xml.end(), cell), end; it != end; ++it)
    ++names[(*it)[1]];
  EXPECT_EQ(names["mul_yz"] + names["mul_zy"], 6);
  EXPECT_EQ(names["sub"], 3);
}

}  // namespace
