// SPDX-License-Identifier: Apache-2.0
#include "options/typed.hpp"
#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/suggest.hpp"
#include "options/help.hpp"
#include "options/values.hpp"

namespace cde::cli {
namespace {

const CLI::Option* option_named(const CLI::App& app, std::string_view name) {
  for (const CLI::Option* o : app.get_options())
    for (const std::string& other : names(*o))
      if (other == name) return o;
  return nullptr;
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// "-1,2", "-inf 0" and "-(a)" are values.
bool looks_like_option(std::string_view word) {
  if (word.starts_with("-inf") || word.starts_with("-nan")) return false;
  return word.size() > 1 && word.front() == '-' &&
         (std::isalpha(static_cast<unsigned char>(word[1])) != 0 || word[1] == '-');
}

bool is_question(const CLI::App& app, const CLI::Option* option) {
  return option == app.get_help_ptr() || option == app.get_help_all_ptr() ||
         option == app.get_version_ptr();
}

/// Reads the words in order. Throws an Error at the first invalid word.
class Reader {
 public:
  Reader(const CLI::App& app, const std::vector<std::string>& words) : app_(app), words_(words) {}

  std::vector<std::string> read() {
    try {
      while (at_ < words_.size()) word();
      end();
    } catch (const Error&) {
      // A question for help on the same command line is answered instead.
      if (!find_question()) throw;
    }
    if (!question_.empty()) {
      std::vector<std::string> asks = {question_};
      if (verb_ != nullptr) asks.insert(asks.begin(), verb_->get_name());
      return asks;
    }
    std::vector<std::string> all = {verb_->get_name()};
    all.insert(all.end(), options_.begin(), options_.end());
    if (!positional_.empty()) all.emplace_back("--");
    all.insert(all.end(), positional_.begin(), positional_.end());
    return all;
  }

 private:
  [[nodiscard]] const CLI::App& owner() const { return verb_ != nullptr ? *verb_ : app_; }
  [[nodiscard]] std::string called() const { return command_name(owner()); }

  /// Looks for a question for help after the invalid word; it is about the verb, if there is one.
  bool find_question() {
    for (; question_.empty() && at_ < words_.size(); ++at_) {
      const CLI::Option* o = option_named(owner(), words_[at_]);
      if (o != nullptr && is_question(owner(), o)) question_ = words_[at_];
    }
    return !question_.empty();
  }

  void word() {
    const std::string& word = words_[at_++];
    if (positional_only_ || !looks_like_option(word))
      verb_ == nullptr ? verb(word) : positional(word);
    else if (word == "--")
      positional_only_ = true;
    else if (word.starts_with("--"))
      long_option(word);
    else
      short_options(word);
  }

  void verb(const std::string& word) {
    for (const CLI::App* one : app_.get_subcommands([](const CLI::App*) { return true; }))
      if (one->get_name() == word) verb_ = one;
    if (verb_ != nullptr) return;
    std::vector<std::string> known;
    for (const CLI::App* one : shown_verbs(app_)) known.push_back(one->get_name());
    check_known(word, known, "verb");
  }

  void positional(const std::string& word) {
    for (const CLI::Option* o : verb_->get_options()) {
      if (!o->get_positional()) continue;
      const bool list = o->get_items_expected_max() > 1;
      if (!list && seen_.contains(o)) continue;
      seen_.emplace(o, option_head(*o));
      check(*o, option_head(*o), word);
      positional_.push_back(word);
      return;
    }
    throw_usage(fmt::format("{} takes no argument {}; `{} --help` lists its arguments", called(),
                            in_quotes(word), called()));
  }

  void long_option(const std::string& word) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    std::optional<std::string> value;
    if (equals != std::string::npos) value = word.substr(equals + 1);
    option(known(name), name, std::move(value));
  }

  /// -q, -qo FILE, -oFILE.
  void short_options(const std::string& word) {
    for (std::size_t i = 1; i < word.size(); ++i) {
      const std::string name = {'-', word[i]};
      if (option_named(owner(), name) == nullptr) (void)known(i == 1 ? word : name);
      const CLI::Option* o = known(name);
      if (!takes_value(*o)) {
        option(o, name, std::nullopt);
        continue;
      }
      std::optional<std::string> value;
      if (i + 1 < word.size()) value = word.substr(i + 1);
      return option(o, name, std::move(value));
    }
  }

  const CLI::Option* known(const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    if (const CLI::Option* o = option_named(owner(), name)) return o;
    if (verb_ == nullptr) {  // may belong to the verb that follows
      for (const std::string& later : words_)
        for (const CLI::App* one : shown_verbs(app_))
          if (one->get_name() == later && option_named(*one, name) != nullptr)
            throw_usage(fmt::format("{} is an option of `{}`; put it after the verb",
                                    in_quotes(name), command_name(*one)));
    }
    std::vector<std::string> others;
    for (const CLI::App* one : shown_verbs(app_))
      if (option_named(*one, name) != nullptr) others.push_back('`' + command_name(*one) + '`');
    if (!others.empty() && name.starts_with("--"))
      throw_usage(fmt::format("{} has no option {}; {} {} it", called(), in_quotes(name),
                              fmt::join(others, ", "), others.size() == 1 ? "has" : "have"));
    std::vector<std::string> all;
    for (const CLI::Option* o : shown_options(owner(), false))
      for (const std::string& other : names(*o)) all.push_back(other);
    const auto near = nearest_word(name, all);
    const bool renamed = std::find(all.begin(), all.end(), new_name(name)) != all.end();
    throw_usage(fmt::format("{} has no option {}; {}", called(), in_quotes(name),
                            renamed ? fmt::format("it is now {}", new_name(name))
                            : near  ? fmt::format("did you mean {}?", *near)
                            : name.find_first_of(" <>=+*/&|?") != std::string::npos
                                ? "put -- before a value that begins with - and a letter"
                                : fmt::format("`{} --help` lists them", called())));
  }

  void option(const CLI::Option* o, const std::string& name, std::optional<std::string> value) {
    if (is_question(owner(), o)) {
      question_ = names(*o).back();
      at_ = words_.size();
      return;
    }
    const auto [before, first] = seen_.emplace(o, name);
    order_.push_back(o);
    for (const CLI::Option* other : o->get_excludes())
      if (const auto found = seen_.find(other); found != seen_.end())
        cannot_combine(name, found->second);
    if (!first && o->get_items_expected_max() <= 1) {
      if (!o->get_fnames().empty() && name != before->second)
        cannot_combine(name, before->second);  // --box and --no-box
      throw_usage(fmt::format("{} is given twice", name));
    }
    if (!takes_value(*o)) {
      // An option with an optional value takes it only after =.
      const bool may_have = value && takes(*o).check;
      if (value && !may_have)
        throw_usage(fmt::format("{} takes no value; it is '{}'", name, printable_name(*value)));
      if (may_have) check(*o, name, *value);
      options_.push_back(may_have ? name + "=" + *value : name);
      return;
    }
    const std::string label = takes(*o).label;
    if (!value) {
      if (at_ == words_.size()) throw_usage(fmt::format("{} needs a value: {}", name, label));
      const std::string& next = words_[at_];
      if (next == "--" || option_named(owner(), next.substr(0, next.find('='))) != nullptr)
        throw_usage(
            fmt::format("{} needs a value: {}; {} is an option", name, label, in_quotes(next)));
      value = next;
      ++at_;
    }
    check(*o, name, *value);
    const std::string whole = names(*o).back();
    options_.push_back(whole + (whole.starts_with("--") ? "=" : "") + *value);
  }

  static void check(const CLI::Option& o, const std::string& name, const std::string& value) {
    const Takes what = takes(o);
    if (value.empty())
      throw_usage(fmt::format("{} is empty; it needs a value: {}", name, what.label));
    if (!what.check) return;
    const char between = o.get_delimiter();
    for (std::size_t start = 0; start <= value.size();) {
      const std::size_t stop =
          between == '\0' ? value.size() : std::min(value.find(between, start), value.size());
      what.check(value.substr(start, stop - start));
      start = stop + 1;
    }
  }

  void end() {
    if (!question_.empty()) return;
    if (verb_ == nullptr)
      throw_usage(fmt::format("a verb is missing; `{} --help` lists them", command_name(app_)));
    for (const CLI::Option* o : verb_->get_options())
      if (o->get_required() && !seen_.contains(o))
        throw_usage(fmt::format("{} needs {}: {}", called(),
                                o->get_positional() ? option_head(*o) : names(*o).back(),
                                o->get_description()));
    for (const CLI::Option* o : order_)
      for (const CLI::Option* other : o->get_needs())
        if (!seen_.contains(other))
          throw_usage(fmt::format("{} needs {}", seen_.at(o), names(*other).back()));
  }

  const CLI::App& app_;
  const std::vector<std::string>& words_;
  std::size_t at_ = 0;
  const CLI::App* verb_ = nullptr;
  bool positional_only_ = false;
  std::string question_;
  std::map<const CLI::Option*, std::string> seen_;  ///< by option: how it was typed first
  std::vector<const CLI::Option*> order_;           ///< the options, as typed
  std::vector<std::string> options_, positional_;
};

}  // namespace

void cannot_combine(std::string_view option, std::string_view other, std::string_view why) {
  throw_usage(fmt::format("{} cannot be combined with {}{}{}", option, other,
                          why.empty() ? "" : "; ", why));
}

void excludes(CLI::App& verb, const std::string& option, const std::vector<std::string>& others) {
  for (const std::string& other : others)
    if (CLI::Option* o = verb.get_option_no_throw(other)) verb.get_option(option)->excludes(o);
}

std::vector<std::string> normalise_arguments(const CLI::App& app,
                                             const std::vector<std::string>& words) {
  return Reader(app, words).read();
}

}  // namespace cde::cli
