// SPDX-License-Identifier: Apache-2.0
#include "cde/wave/scope_views.hpp"

#include <algorithm>
#include <set>

namespace cde::wave {

std::vector<View> views_in_scopes(const Request& r, Trace& trace, bool once) {
  std::vector<View> all;
  std::set<std::uint32_t> seen;
  const std::vector<std::string> words = r.words.empty() ? std::vector<std::string>{"*"} : r.words;
  const FileForms file_forms(trace);
  const Form asked = r.default_form();
  for (const std::string& word : words) {
    // A plain name is a scope here or a signal below. The same holds for a pattern followed by a
    // form.
    std::vector<std::string> forms = {word + ".*", "*." + word + ".*"};
    if (word.find_first_of("*?") != std::string::npos) {
      forms.push_back(word);
      forms.push_back("*." + word);
    }
    bool any = false;
    for (const Signal& s : trace.signals()) {
      if (std::none_of(forms.begin(), forms.end(),
                       [&](const std::string& f) { return matches(f, s.name); }))
        continue;
      any = true;
      if (once && !seen.insert(s.handle).second) continue;
      View v;
      v.signal = s;
      v.label = s.name;
      v.width = s.width;
      v.form = file_forms.of(s, asked);
      all.push_back(std::move(v));
    }
    if (any) continue;
    for (View& v : views(trace, word, r.default_form())) all.push_back(std::move(v));
  }
  return all;
}

}  // namespace cde::wave
