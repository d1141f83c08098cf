// Knobs: settings of a kernel by name, so that experiments, quality ladders and a person at a
// keyboard turn the same ones. A list is written "kept=512 space=cells". Each kernel has its own
// table (knobs.cpp of its folder) of what there is, what is allowed, and where the value goes.
#pragma once

#include <array>
#include <charconv>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.h"

namespace macula::kernels {

struct KnobValue {
  std::string name, value;
  friend bool operator==(const KnobValue&, const KnobValue&) = default;
};
using KnobValues = std::vector<KnobValue>;

/// "name=value" words with blanks between; an error names the word that is none.
Result<KnobValues> parse_knobs(std::string_view text);
std::string text_of(const KnobValues& knobs);

/// One knob of a kernel whose settings are a Config.
template <class Config>
struct Knob {
  std::string_view name;
  std::string_view allowed;                              ///< for people
  bool (*turn)(Config& config, std::string_view value);  ///< false: not allowed, nothing changed
};

/// Into `target` if it is a number in [low, high] and nothing else.
template <class Number>
bool turn_number(Number& target, std::string_view value, Number low, Number high) {
  Number number{};
  const char* end = value.data() + value.size();
  const auto read = std::from_chars(value.data(), end, number);
  if (read.ec != std::errc{} || read.ptr != end || !(number >= low && number <= high)) return false;
  target = number;
  return true;
}

/// Into `target` the choice of that name.
template <class Choice, std::size_t kCount>
bool turn_choice(Choice& target, std::string_view value,
                 const std::array<std::pair<std::string_view, Choice>, kCount>& choices) {
  for (const auto& [name, choice] : choices) {
    if (name != value) continue;
    target = choice;
    return true;
  }
  return false;
}

Error unknown_knob(std::string_view kernel, const KnobValue& knob, const std::string& names);
Error bad_knob(std::string_view kernel, const KnobValue& knob, std::string_view allowed);

/// Turns each in the order given; an unknown one answers with the list, a bad value with what is
/// allowed.
template <class Config, std::size_t kCount>
Result<void> turn_knobs(std::string_view kernel, const std::array<Knob<Config>, kCount>& table,
                        std::span<const KnobValue> values, Config& config) {
  for (const KnobValue& value : values) {
    std::string names;
    const Knob<Config>* found = nullptr;
    for (const Knob<Config>& knob : table) {
      names += (names.empty() ? "" : ", ") + std::string(knob.name);
      if (knob.name == value.name) found = &knob;
    }
    if (found == nullptr) return tl::unexpected(unknown_knob(kernel, value, names));
    if (!found->turn(config, value.value))
      return tl::unexpected(bad_knob(kernel, value, found->allowed));
  }
  return {};
}

}  // namespace macula::kernels
