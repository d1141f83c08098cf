#include "server/kernels/knobs.h"

#include "shared/base/text.h"

namespace macula::kernels {

Result<KnobValues> parse_knobs(std::string_view text) {
  KnobValues knobs;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (word.empty()) continue;
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string_view::npos || equals + 1 == word.size())
      return base::bad_input(base::concat("'", word, "' is no knob"), "knobs",
                             "words such as samples=4, with blanks between");
    knobs.push_back({std::string(word.substr(0, equals)), std::string(word.substr(equals + 1))});
  }
  return knobs;
}

std::string text_of(const KnobValues& knobs) {
  std::string text;
  for (const KnobValue& knob : knobs)
    text += base::concat(text.empty() ? "" : " ", knob.name, "=", knob.value);
  return text;
}

Error unknown_knob(std::string_view kernel, const KnobValue& knob, const std::string& names) {
  return {base::concat("unknown knob '", knob.name, "'"), base::concat("kernel ", kernel),
          "it has: " + names};
}

Error bad_knob(std::string_view kernel, const KnobValue& knob, std::string_view allowed) {
  return {base::concat("knob ", knob.name, " is '", knob.value, "'"),
          base::concat("kernel ", kernel), base::concat("allowed: ", allowed)};
}

}  // namespace macula::kernels
