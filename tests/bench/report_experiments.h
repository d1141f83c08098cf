// What the report page shows first of each experiment: the page's own words for it, and the axes
// and the series of its first chart.
#pragma once

#include <string_view>

namespace macula::bench {

struct ExperimentView {
  std::string_view experiment;  ///< as in its report
  std::string_view lead;        ///< a sentence or two for who sees it for the first time
  std::string_view x, y;        ///< columns
  std::string_view series;      ///< the column whose values have colours of their own; may be empty
};

/// Of unknown experiments: one without words and columns.
const ExperimentView& experiment_view(std::string_view experiment);
/// Its place on the page: what sums up comes first, unknown ones last.
int experiment_order(std::string_view experiment);

}  // namespace macula::bench
