// What the four papers report of speed and accuracy, to stand beside our own. Their milliseconds
// are those of their graphics cards; factors and errors carry over. Numbers are the papers' own.
#pragma once

#include <span>
#include <string_view>

namespace macula::bench {

struct PaperPoint {
  std::string_view kernel;  ///< of ours that follows the paper
  std::string_view paper, place;
  std::string_view setting, quantity;
  double value = 0.0;
};
std::span<const PaperPoint> paper_points();

}  // namespace macula::bench
