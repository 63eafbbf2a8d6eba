// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_cde.hpp"

/// Pages that the command writes, as text and in a browser.
namespace cde::testing {

[[nodiscard]] std::size_t count(const std::string& text, const std::string& part);
/// All texts between `begin` and `end`.
[[nodiscard]] std::vector<std::string> between(const std::string& text, const std::string& begin,
                                               const std::string& end);
/// The text before it was escaped for an element.
[[nodiscard]] std::string plain(std::string text);
/// The browser for these tests; empty if there is none.
[[nodiscard]] std::string browser();

class Pages : public Cli {
 protected:
  /// Runs a script in the page and returns the result of `answer` for the text that the script
  /// leaves in its element "told". The browser has no network. The page's own content security
  /// policy applies, extended for this script. Virtual time does not wait for threads of the
  /// browser. While the element is missing or `answer` returns null, the page therefore runs again
  /// with more virtual time.
  nlohmann::json in_browser(std::string html, const std::string& script, const std::string& flags,
                            const std::function<nlohmann::json(const std::string&)>& answer);
  /// On a phone 400 pixels wide nothing is wider than the page. Captions are complete, and no
  /// column head has one word per line.
  void expect_fits_a_phone(const std::string& html);
  /// Reports of a click on every button that saves a file.
  nlohmann::json clicked(const std::string& html);
  /// Two files per chart: a picture that opens alone, and its figures.
  void expect_saved(const nlohmann::json& told, std::size_t charts);
  /// The hash for a content security policy, from coreutils' own implementation.
  std::string policy_hash(const std::string& text);
  /// The page loads nothing, runs only the scripts that the policy names, and closes its elements.
  void expect_sound(const std::string& html, std::size_t scripts);
};

}  // namespace cde::testing
