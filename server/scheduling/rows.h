// Rows of a picture, from `begin` to before `end`.
#pragma once

#include <algorithm>

namespace macula::scheduling {

struct Rows {
  int begin = 0, end = 0;

  int count() const { return std::max(end - begin, 0); }
};

inline Rows common(const Rows& a, const Rows& b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}
/// The least that holds both; empty ones count for nothing.
inline Rows span_of(const Rows& a, const Rows& b) {
  if (a.count() == 0) return b;
  if (b.count() == 0) return a;
  return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

}  // namespace macula::scheduling
