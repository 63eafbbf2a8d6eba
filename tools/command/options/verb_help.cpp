// SPDX-License-Identifier: Apache-2.0
#include "options/verb_help.hpp"

#include <algorithm>
#include <map>

namespace cde::cli {
namespace {

/// What a verb does, as far as its exit status and the environment depend on it.
enum Does : unsigned {
  kNothing = 0,
  kModels = 1,   ///< looks for bitstreams, and builds those that are missing
  kSources = 2,  ///< reads the RTL, and keeps what it learns in the cache
  kCards = 4,    ///< opens whole cards
  kMeshes = 8,   ///< imports meshes
  kPrices = 16,  ///< reads measured prices
  kWidth = 32,   ///< draws text as wide as the terminal
  kAnything = kModels | kSources | kCards | kMeshes | kPrices | kWidth,
  kCompares = 64,   ///< compares the card with the reference
  kSimulates = 128  ///< waits for a card, which may fail
};

struct Variable {
  const char *name, *text;
  unsigned read_for;  ///< any of these bits
};
constexpr Variable kVariables[] = {
    {"CDE_CACHE", "folder where bitstreams and figures of the RTL are kept [~/.cache/cde]",
     kModels | kSources},
    {"CDE_BITSTREAMS", "folder that is searched for bitstreams before all others", kModels},
    {"CDE_SHARE",
     "folder with rtl/, verilator/, docs/ and host/include/, instead of this project's",
     kModels | kSources | kPrices},
    {"CDE_PRICES", "table of measured prices [docs/prices.json]", kPrices},
    {"CDE_CLANG", "compiler of bitstreams [clang++]", kModels},
    {"CDE_MARCH", "processor that bitstreams are compiled for, as in -march [native]", kModels},
    {"CDE_ASSERT", "1: bitstreams with the assertions of the RTL", kModels},
    {"CDE_MESH_MEMORY", "MB that importing a mesh may take [512 and 64 times the file, up to 2048]",
     kMeshes},
    {"CDE_MESH_SECONDS", "seconds that importing a mesh may take [30]", kMeshes},
    {"CDE_WAVES", "folder: every card that is opened writes waves, board-N.fst", kCards},
    {"COLUMNS", "width of the text where stdout is no terminal [80]", kWidth},
    {"NO_COLOR", "not empty: no colours, on a terminal either", kAnything},
};

struct VerbFacts {
  std::string_view verb;
  unsigned does;
  const char* status_1 = nullptr;  ///< what status 1 means; null: the verb does not have it
};
constexpr unsigned kCast = kModels | kCards | kMeshes | kPrices | kCompares | kSimulates;
constexpr unsigned kBench = kModels | kCards | kCompares | kSimulates;
constexpr VerbFacts kFacts[] = {
    {"", kAnything | kCompares | kSimulates,
     "doctor found something wrong; wave find, wave tx or advise found nothing; or wave diff found "
     "a difference"},
    {"cast", kCast},
    {"render", kCast},
    {"query", kModels | kCompares | kSimulates},
    {"run", kCast},
    {"plan", kModels | kMeshes | kPrices},
    {"fp", kModels | kSimulates},
    {"merge", kModels | kMeshes | kPrices | kCompares},
    {"doctor", kModels | kCards, "something is wrong"},
    {"help", kWidth},
    {"explain", kModels | kSources | kCards | kMeshes | kCompares | kSimulates},
    {"accuracy", kModels | kSources | kMeshes | kPrices | kCompares | kSimulates},
    {"advise", kPrices, "no pipe meets the demands"},
    {"bench", kBench},
    {"reproduce", kBench | kPrices},
    {"inventory", kSources},
    {"wave", kSources | kWidth, "find or tx found nothing, or diff found a difference"},
    {"wave show", kWidth},
    {"wave find", kNothing, "the expression is true nowhere"},
    {"wave diff", kNothing, "the files differ"},
    {"wave serve", kSources},
    {"wave tui", kSources},
    {"wave tx", kNothing, "no transaction was found"},
    {"wave why", kSources}};

/// A verb that is not listed does nothing of the kind.
VerbFacts facts(std::string_view verb) {
  const auto* const found = std::find_if(std::begin(kFacts), std::end(kFacts),
                                         [&](const VerbFacts& f) { return f.verb == verb; });
  return found == std::end(kFacts) ? VerbFacts{verb, kNothing} : *found;
}

using ExampleTable = std::map<std::string_view, std::vector<Example>>;

ExampleTable examples_of_cde() {
  return {
      {"",
       {{"cde render bunny.ply", "Draw a mesh, every pixel a ray through the simulated card"},
        {"cde run meshes/scenes/mixed.toml --report page.html", "Play a scene and see it"}}},
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
         "Pairs from a text by another algorithm, answers as bits"},
        {"cde query obb-obb pairs.npy -o answers.csv", "Pairs of an array, 30 numbers each"}}},
      {"run",
       {{"cde run meshes/scenes/spheres.toml --frames 0..3 -o spheres.run",
         "Four frames of a scene"},
        {"cde run meshes/scenes/mixed.toml --report page.html", "A page about the run"}}},
      {"plan",
       {{"cde plan meshes/scenes/spheres.toml", "What the card of a scene has, and why"},
        {"cde plan meshes/scenes/flight.toml --json", "The same for programs"}}},
      {"fp",
       {{"echo '3F800000 40000000' | cde fp add", "1 + 2 in binary32"},
        {"testfloat_gen f16_mul | cde fp f16_mul | testfloat_ver f16_mul",
         "Half precision, judged by Berkeley TestFloat"}}},
      {"merge",
       {{"cde merge part1.journal part2.journal part3.journal",
         "What three runs with --shard 1/3, 2/3 and 3/3 come to"},
        {"cde merge shards/*", "Of as many as there are, in any order"}}},
      {"doctor",
       {{"cde doctor", "See whether everything is here that the command needs"},
        {"CDE_CLANG=clang++-16 cde doctor", "The same for another compiler of bitstreams"}}},
      {"version",
       {{"cde version", "The same as cde --version"}, {"cde version | head -n 1", "That of cde"}}},
      {"help", {{"cde help cast", "One verb"}, {"cde --help-all | less", "All of them"}}},
  };
}

ExampleTable examples_of_programs() {
  return {
      {"explain",
       {{"cde explain sphere-sphere '0 0 0 1 | 1.5 0 0 1'",
         "Every operator of the pipe beside the reference's, with its clock and line"},
        {"cde explain --from-record meshes/scenes/mixed.toml:seen:0:7",
         "How the record of a primary of a scene came about, in query seen of frame 0"}}},
      {"accuracy",
       {{"cde accuracy --pair obb-obb,ray-triangle --formats fp16,fp32 --by-family",
         "Errors and wrong decisions of two pairs in two formats, family by family"},
        {"cde accuracy --cases 100000 --resume accuracy.journal --json -o accuracy.json",
         "Everything, in a run that may be stopped and started again"}}},
      {"advise",
       {{"cde advise --max-error 1e-3 --no-leaks --max-wrong 1000 --time 10ms",
         "The cheapest ray-triangle pipe that is as good and takes a million tests in 10 ms"},
        {"cde advise --pair obb-obb --max-error 1e-2 --time 10ms --target assumed:200MHz --from "
         "accuracy.json",
         "Of a sweep of one's own, at a clock that no device is asked for"}}},
      {"bench",
       {{"cde bench --quick", "All sections, small"},
        {"cde bench rays bus --json", "Two sections for programs"}}},
      {"reproduce",
       {{"cde reproduce -o figures.html", "The figures of the paper on this machine"},
        {"cde reproduce --quick --json", "A small run for programs"}}},
      {"inventory",
       {{"cde inventory sphere-sphere obb-obb", "Two pairs"},
        {"cde inventory --markdown > inventory.md", "All pipes as tables for a document"}}},
  };
}

ExampleTable examples_of_wave() {
  return {
      {"wave",
       {{"cde cast terrain:3,3,1 --grid 4x4 --trace waves.fst",
         "Waves of a small cast, for the examples of the verbs"},
        {"cde wave show waves.fst clk_i 'ddr_data_i[2]:fp32' --around cyc:100 --window 5",
         "Waves of a clock and a word of memory as text, five cycles before and behind cycle 100"},
        {"cde wave find waves.fst irq_o --on 'posedge clk_i' --first",
         "The first clock edge at which the card asks for an interrupt"}}},
      {"wave info",
       {{"cde wave info waves.fst", "Time unit, size, clock and comments"},
        {"cde wave info waves.fst --json", "The same for programs"}}},
      {"wave ls",
       {{"cde wave ls waves.fst '*valid*' --max 0", "All signals whose names have valid in them"},
        {"cde wave ls waves.fst engine", "The signals in and below a scope"}}},
      {"wave at",
       {{"cde wave at waves.fst cyc:100 'ddr_data_i[2]:fp32' irq_o", "Two values at a cycle"},
        {"cde wave at waves.fst end bus_rdata_o --as dec",
         "A value at the end, as a decimal number"}}},
      {"wave show",
       {{"cde wave show waves.fst clk_i 'ddr_data_i[2]:fp32' --around cyc:100 --window 5",
         "A clock and a word of memory, five cycles before and behind cycle 100"},
        {"cde wave show waves.fst --from cyc:0 --to cyc:20 --ascii",
         "The outermost signals in the first cycles, without Unicode"}}},
      {"wave find",
       {{"cde wave find waves.fst irq_o --on 'posedge clk_i' --first",
         "The first clock edge at which the card asks for an interrupt"},
        {"cde wave find waves.fst 'ddr_data_i[2]:fp32 > 200 && ddr_valid_i' --count",
         "How often a word of memory is above 200"}}},
      {"wave diff",
       {{"cde wave diff waves.fst other.fst", "Where each signal of two files differs first"},
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
        {"cde wave tx waves.fst --histogram latency", "How long transactions take"}}},
      {"wave why",
       {{"cde wave why waves.fst irq_o@cyc:300", "What made the card ask for an interrupt"},
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
