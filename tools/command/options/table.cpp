// SPDX-License-Identifier: Apache-2.0
#include "options/table.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "options/help.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

OptionEntry entry_of(const CLI::Option& o, bool positional) {
  return {o.get_snames(), o.get_lnames(), o.get_description(),
          takes(o),       positional,     o.get_expected_max() > 1};
}

}  // namespace

VerbTable table_of(const CLI::App& app) {
  VerbTable table{app.get_name(), app.get_description(), {}};
  for (const bool positional : {true, false})
    for (const CLI::Option* o : shown_options(app, positional))
      table.options.push_back(entry_of(*o, positional));
  for (const CLI::App* verb : shown_verbs(app)) table.verbs.push_back(table_of(*verb));
  return table;
}

Json to_json(const VerbTable& table) {
  Json options = Json::array(), verbs = Json::array();
  for (const OptionEntry& o : table.options)
    options.push_back({{"short_names", o.short_names},
                       {"long_names", o.long_names},
                       {"text", o.text},
                       {"kind", static_cast<int>(o.takes.kind)},
                       {"words", o.takes.words},
                       {"label", o.takes.label},
                       {"positional", o.positional},
                       {"list", o.list}});
  for (const VerbTable& verb : table.verbs) verbs.push_back(to_json(verb));
  return {{"name", table.name}, {"text", table.text}, {"options", options}, {"verbs", verbs}};
}

VerbTable table_from_json(const Json& j) {
  VerbTable table{j.at("name").get<std::string>(), j.at("text").get<std::string>(), {}};
  for (const Json& o : j.at("options")) {
    OptionEntry entry;
    entry.short_names = o.at("short_names").get<std::vector<std::string>>();
    entry.long_names = o.at("long_names").get<std::vector<std::string>>();
    entry.text = o.at("text").get<std::string>();
    entry.takes.kind = static_cast<Takes::Kind>(o.at("kind").get<int>());
    entry.takes.words = o.at("words").get<std::vector<std::string>>();
    entry.takes.label = o.at("label").get<std::string>();
    entry.positional = o.at("positional").get<bool>(), entry.list = o.at("list").get<bool>();
    table.options.push_back(std::move(entry));
  }
  for (const Json& verb : j.at("verbs")) table.verbs.push_back(table_from_json(verb));
  return table;
}

}  // namespace cde::cli
