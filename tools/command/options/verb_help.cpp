// SPDX-License-Identifier: Apache-2.0
#include "options/verb_help.hpp"

#include <algorithm>
#include <map>

namespace cde::cli {
namespace {

/// What a verb does. Its exit statuses and environment variables depend on it.
enum Does : unsigned {
  kNothing = 0,
  kModels = 1,   ///< uses simulation models, and builds missing ones
  kSources = 2,  ///< reads the RTL, and caches results
  kCards = 4,    ///< opens whole cards
  kFiles = 8,    ///< reads meshes, scenes or waves
  kCosts = 16,   ///< reads measured costs
  kWidth = 32,   ///< prints text as wide as the terminal
  kAnything = kModels | kSources | kCards | kFiles | kCosts | kWidth,
  kCompares = 64,   ///< compares the card with the reference
  kSimulates = 128  ///< waits for a card, which may fail
};

struct Variable {
  const char *name, *text;
  unsigned read_for;  ///< any of these bits
};
constexpr Variable kVariables[] = {
    {"CDE_CACHE", "folder for simulation models and figures of the RTL [~/.cache/cde]",
     kModels | kSources},
    {"CDE_MODELS", "folder that is searched first for simulation models", kModels},
    {"CDE_SHARE",
     "folder with rtl/, verilator/, docs/ and host/include/, in place of this project's",
     kModels | kSources | kCosts},
    {"CDE_COSTS", "table of measured costs [docs/costs.json]", kCosts},
    {"CDE_CLANG", "compiler of simulation models [clang++]", kModels},
    {"CDE_MARCH", "processor for which simulation models are compiled, as in -march [native]",
     kModels},
    {"CDE_ASSERT", "1: simulation models with the assertions of the RTL", kModels},
    {"CDE_READ_MEMORY",
     "MB for a mesh [512 plus 64 times the file, at most 2048], a scene or wave file [2048 plus 64 "
     "times the file]",
     kFiles},
    {"CDE_READ_SECONDS",
     "seconds for importing a mesh [30], and of processor time for a wave file [30 plus 10 per MB]",
     kFiles},
    {"CDE_WAVES", "folder: every card that is opened writes waves, board-N.fst", kCards},
    {"COLUMNS", "width of text where stdout is no terminal [80]", kWidth},
    {"NO_COLOR", "not empty: no colours, on a terminal either", kAnything},
};

struct VerbFacts {
  std::string_view verb;
  unsigned does;
  const char* status_1 = nullptr;  ///< what status 1 means; null: the verb does not have it
};
constexpr unsigned kCast = kModels | kCards | kFiles | kCosts | kCompares | kSimulates;
constexpr unsigned kBench = kModels | kCards | kCompares | kSimulates;
constexpr VerbFacts kFacts[] = {
    {"", kAnything | kCompares | kSimulates,
     "doctor found a fault; wave find, wave tx or advise found nothing; or wave diff found a "
     "difference"},
    {"cast", kCast},
    {"render", kCast},
    {"query", kModels | kCompares | kSimulates},
    {"run", kCast},
    {"plan", kModels | kFiles | kCosts},
    {"fp", kModels | kSimulates},
    {"merge", kModels | kFiles | kCosts | kCompares},
    {"doctor", kModels | kCards, "a fault was found"},
    {"help", kWidth},
    {"explain", kModels | kSources | kCards | kFiles | kCompares | kSimulates},
    {"accuracy", kModels | kSources | kFiles | kCosts | kCompares | kSimulates},
    {"advise", kCosts, "no pipe meets the demands"},
    {"bench", kBench | kFiles},
    {"reproduce", kBench | kCosts},
    {"inventory", kSources},
    {"wave", kSources | kWidth, "find or tx found nothing, or diff found a difference"},
    {"wave show", kWidth},
    {"wave find", kNothing, "the expression is true nowhere"},
    {"wave diff", kNothing, "the files differ"},
    {"wave serve", kSources},
    {"wave tui", kSources},
    {"wave tx", kNothing, "no transaction was found"},
    {"wave why", kSources}};

/// The facts of a verb; a verb that is not listed has none.
VerbFacts facts(std::string_view verb) {
  const auto* const found = std::find_if(std::begin(kFacts), std::end(kFacts),
                                         [&](const VerbFacts& f) { return f.verb == verb; });
  VerbFacts all = found == std::end(kFacts) ? VerbFacts{verb, kNothing} : *found;
  if (verb.starts_with("wave")) all.does |= kFiles;
  return all;
}

using ExampleTable = std::map<std::string_view, std::vector<Example>>;

ExampleTable examples_of_cde() {
  return {
      {"",
       {{"cde render bunny.ply", "Draw a mesh; every pixel is a ray through the simulated card"},
        {"cde run meshes/scenes/mixed.toml --report page.html",
         "Run a scene and write a page about it"}}},
      {"cast",
       {{"cde cast bunny.ply --grid 64x64 -o hits.csv", "A grid of rays straight down"},
        {"cde cast terrain --ray 1450,2000,900,0,0,-1 --ray 100,100,900,0,0,-1 -o -",
         "Two rays straight down at the built-in terrain, records on stdout"}}},
      {"render",
       {{"cde render bunny.ply --up y --size 640x480 --shaded bunny.png",
         "A picture of a mesh whose y axis points up"},
        {"cde render terrain --shaded sun.png --shadows --image depth.pfm",
         "Sunlight with shadows, and the depths"}}},
      {"query",
       {{"echo '0,0,0,1, 1.5,0,0,1' | cde query sphere-sphere", "Two spheres: centre and radius"},
        {"cde query ray-triangle --algorithm watertight --bits < pairs.csv",
         "Pairs from a text file with another algorithm, answers as bits"},
        {"cde query obb-obb pairs.npy -o answers.csv", "Pairs from an array, 30 numbers each"}}},
      {"run",
       {{"cde run meshes/scenes/spheres.toml --frames 0..3 -o spheres.run",
         "Four frames of a scene"},
        {"cde run meshes/scenes/mixed.toml --report page.html", "Write a page about the run"}}},
      {"plan",
       {{"cde plan meshes/scenes/spheres.toml", "Show which card a scene needs, and why"},
        {"cde plan meshes/scenes/flight.toml --json", "The same for programs"}}},
      {"fp",
       {{"echo '3F800000 40000000' | cde fp add", "1 + 2 in binary32"},
        {"testfloat_gen f16_mul | cde fp f16_mul | testfloat_ver f16_mul",
         "Half precision, checked by Berkeley TestFloat"}}},
      {"merge",
       {{"cde merge part1.journal part2.journal part3.journal",
         "Merge three runs with --shard 1/3, 2/3 and 3/3"},
        {"cde merge shards/*", "Any number of journals, in any order"}}},
      {"doctor",
       {{"cde doctor", "Check everything that the command needs"},
        {"CDE_CLANG=clang++-16 cde doctor",
         "The same with another compiler of simulation models"}}},
      {"version",
       {{"cde version", "The same as cde --version"},
        {"cde version | head -n 1", "The version of cde only"}}},
      {"help", {{"cde help cast", "One verb"}, {"cde --help-all | less", "All verbs"}}},
  };
}

ExampleTable examples_of_programs() {
  return {
      {"explain",
       {{"cde explain sphere-sphere '0 0 0 1 | 1.5 0 0 1'",
         "Compare every operator of the pipe with the reference, with its cycle and line"},
        {"cde explain --from-record meshes/scenes/mixed.toml:seen:0:7",
         "Explain the record of primary 7 of a scene, in query seen of frame 0"}}},
      {"accuracy",
       {{"cde accuracy --pair obb-obb,ray-triangle --formats fp16,fp32 --by-family",
         "Errors and wrong decisions of two pairs in two formats, family by family"},
        {"cde accuracy --cases 100000 --resume accuracy.journal --json -o accuracy.json",
         "All pairs and formats, in a run that can be stopped and continued"}}},
      {"advise",
       {{"cde advise --max-error 1e-3 --no-leaks --max-wrong 1000 --time 10ms",
         "The cheapest ray-triangle pipe that is accurate enough and runs a million tests in 10 "
         "ms"},
        {"cde advise --pair obb-obb --max-error 1e-2 --time 10ms --target assumed:200MHz --from "
         "accuracy.json",
         "The same from another measurement, at an assumed clock"}}},
      {"bench",
       {{"cde bench --quick", "All sections, small"},
        {"cde bench rays bus --json", "Two sections for programs"},
        {"cde bench gpu --list", "The OpenCL devices of this machine"},
        {"cde bench gpu --opencl-device 0 --json", "Rays on the first of them, without a card"}}},
      {"reproduce",
       {{"cde reproduce -o figures.html", "Measure the figures of the paper on this machine"},
        {"cde reproduce --quick --json", "A small run for programs"}}},
      {"inventory",
       {{"cde inventory sphere-sphere obb-obb", "Operators and latency of two pairs"},
        {"cde inventory --markdown > inventory.md", "All pipes as tables for a document"}}},
  };
}

ExampleTable examples_of_wave() {
  return {
      {"wave",
       {{"cde cast terrain:3,3,1 --grid 4x4 --trace waves.fst",
         "Write waves of a small cast, for the examples of the verbs"},
        {"cde wave show waves.fst clk_i 'ddr_data_i[2]:fp32' --around cyc:100 --window 5",
         "Draw a clock and a word of memory as text, five cycles before and after cycle 100"},
        {"cde wave find waves.fst irq_o --on 'posedge clk_i' --first",
         "The first clock edge at which the card requests an interrupt"}}},
      {"wave info",
       {{"cde wave info waves.fst", "Time unit, size, clock and comments"},
        {"cde wave info waves.fst --json", "The same for programs"}}},
      {"wave ls",
       {{"cde wave ls waves.fst '*valid*' --max 0", "All signals with valid in their names"},
        {"cde wave ls waves.fst engine", "The signals in and below a scope"}}},
      {"wave at",
       {{"cde wave at waves.fst cyc:100 'ddr_data_i[2]:fp32' irq_o", "Two values at a cycle"},
        {"cde wave at waves.fst end bus_rdata_o --as dec",
         "A value at the end, as a decimal number"}}},
      {"wave show",
       {{"cde wave show waves.fst clk_i 'ddr_data_i[2]:fp32' --around cyc:100 --window 5",
         "A clock and a word of memory, five cycles before and after cycle 100"},
        {"cde wave show waves.fst --from cyc:0 --to cyc:20 --ascii",
         "The outermost signals in the first cycles, without Unicode"}}},
      {"wave find",
       {{"cde wave find waves.fst irq_o --on 'posedge clk_i' --first",
         "The first clock edge at which the card requests an interrupt"},
        {"cde wave find waves.fst 'ddr_data_i[2]:fp32 > 200 && ddr_valid_i' --count",
         "Count the places where a word of memory is above 200"}}},
      {"wave diff",
       {{"cde wave diff waves.fst other.fst", "The first difference of each signal in two files"},
        {"cde wave diff waves.fst other.fst --align cycle --as fp32 --ulp 1",
         "Cycle by cycle; neighbouring numbers are equal"}}},
      {"wave stat",
       {{"cde wave stat waves.fst", "All handshakes and pipes"},
        {"cde wave stat waves.fst --from cyc:100 --to cyc:200 --json",
         "A hundred cycles, for programs"}}},
      {"wave export",
       {{"cde wave export waves.fst clk_i 'ddr_data_i[2]:fp32' -o memory.csv",
         "A clock and a word of memory as CSV"},
        {"cde wave export waves.fst --around cyc:100 --window 5 -o near.fst",
         "All signals in eleven cycles"}}},
      {"wave serve",
       {{"cde wave serve waves.fst -o waves.html", "A page of all signals"},
        {"cde wave serve waves.fst clk_i irq_o --around cyc:100 -o irq.html",
         "A page that begins with two signals"}}},
      {"wave tui",
       {{"cde wave tui waves.fst", "The viewer on this terminal"},
        {"cde wave tui waves.fst --diff other.fst",
         "The same, with differences from another file marked"}}},
      {"wave tx",
       {{"cde wave tx waves.fst pass --json", "Passes of a card, for programs"},
        {"cde wave tx waves.fst --histogram latency", "Histogram of the latency of transactions"}}},
      {"wave why",
       {{"cde wave why waves.fst irq_o@cyc:300", "Why the card requests an interrupt"},
        {"cde wave why waves.fst irq_o@cyc:300 --depth 0",
         "The same without looking through registers"}}},
  };
}

}  // namespace

const std::vector<Example>& examples(std::string_view verb) {
  static const ExampleTable kAll = [] {
    ExampleTable all = examples_of_cde();
    all.merge(examples_of_programs());
    all.merge(examples_of_wave());
    return all;
  }();
  static const std::vector<Example> kNone;
  const auto found = kAll.find(verb);
  return found == kAll.end() ? kNone : found->second;
}

std::vector<HelpEntry> exit_statuses(std::string_view verb) {
  const VerbFacts f = facts(verb);
  std::vector<HelpEntry> all = {{"0", "success"}};
  if (f.status_1 != nullptr) all.push_back({"1", f.status_1});
  all.push_back(
      {"2", "an option, a file or another input is invalid, or an output cannot be written"});
  if ((f.does & kCompares) != 0)
    all.push_back({"3", "an answer of the card differs from the reference"});
  if ((f.does & kSimulates) != 0)
    all.push_back({"4", "a deadline passed, or the card failed otherwise"});
  all.push_back({"128 + N", "ended by signal N; unfinished files are removed"});
  return all;
}

std::vector<HelpEntry> environment(std::string_view verb) {
  const unsigned does = facts(verb).does;
  std::vector<HelpEntry> all;
  for (const Variable& v : kVariables)
    if ((v.read_for & does) != 0 || v.read_for == kAnything) all.push_back({v.name, v.text});
  return all;
}

}  // namespace cde::cli
