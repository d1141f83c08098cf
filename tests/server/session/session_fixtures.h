// Messages and random bits for the session tests; times are milliseconds after an arbitrary origin.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "server/session/session_table.h"
#include "shared/math/hash.h"

namespace macula::session::test {

inline ServerTime at_ms(double ms) {
  return ServerTime{std::chrono::hours{1} + units::from_ms(ms)};
}

inline foveation::Display small_display() {
  return {math::symmetric_fov(Degrees{90.0}, 1.0), 64, 64};
}

inline net::Hello hello(std::size_t eyes = 2) {
  net::Hello hello;
  hello.program = "test";
  hello.eyes.assign(eyes, small_display());
  hello.codecs = {"jpeg", "lossless"};
  return hello;
}

inline ClientSetup setup(std::size_t eyes = 2) {
  return {std::vector<foveation::Display>(eyes, small_display()), 72.0, {}};
}

inline net::ViewState view(std::uint64_t sequence, std::size_t eyes = 2) {
  net::ViewState view;
  view.sequence = sequence;
  net::EyeState eye;
  eye.fov = small_display().fov;
  view.eyes.assign(eyes, eye);
  return view;
}

/// Deterministic bits for ids, epochs and tokens.
inline SessionTable::RandomBits counted_bits(std::uint64_t seed = 1) {
  return [seed, count = std::uint64_t{0}]() mutable { return math::hash_combine(seed, ++count); };
}

template <class Kind>
std::vector<Kind> all_of(const Actions& actions) {
  std::vector<Kind> found;
  for (const Action& action : actions)
    if (const auto* specific = std::get_if<Kind>(&action)) found.push_back(*specific);
  return found;
}

}  // namespace macula::session::test
