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
/// What stands between `begin` and `end`, every time.
[[nodiscard]] std::vector<std::string> between(const std::string& text, const std::string& begin,
                                               const std::string& end);
/// Text as it was before it was escaped for an element.
[[nodiscard]] std::string plain(std::string text);
/// The browser that opens pages in these tests; empty if there is none.
[[nodiscard]] std::string browser();

class Pages : public Cli {
 protected:
  /// What `answer` makes of the text that the script leaves in an element "told" of the page, in a
  /// browser without network, under the page's own content security policy, which here lets the
  /// script run. Virtual time does not wait for threads of the browser: while there is no such
  /// element, or null is made of it, the page is asked again with more of it.
  nlohmann::json in_browser(std::string html, const std::string& script, const std::string& flags,
                            const std::function<nlohmann::json(const std::string&)>& answer);
  /// What a phone 400 pixels wide shows: nothing is wider than the page, captions are whole, and no
  /// head of a column has a line per word.
  void expect_fits_a_phone(const std::string& html);
  /// What is told of a click on every button that saves something.
  nlohmann::json clicked(const std::string& html);
  /// Two files a chart: a picture that opens alone, and figures.
  void expect_saved(const nlohmann::json& told, std::size_t charts);
  /// As a content security policy has it, from coreutils' own implementation.
  std::string policy_hash(const std::string& text);
  /// Nothing is loaded, nothing runs but what the policy names, and elements are closed.
  void expect_sound(const std::string& html, std::size_t scripts);
};

}  // namespace cde::testing
