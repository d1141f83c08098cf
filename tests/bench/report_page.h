// `macula-bench report`: one HTML page of everything that experiments have left behind. It is
// whole: no other file, nothing from the network; it can be mailed. Curves are drawn in the page
// from the rows it carries, so a reader chooses what is shown over what.
#pragma once

#include <string>
#include <vector>

#include "shared/base/result.h"

namespace macula::bench {

struct PageOptions {
  std::vector<std::string> inputs;  ///< reports, or folders of them
  std::string out = "report.html";
};

/// Errors name the file that is no report, or the place that cannot be written.
Result<void> run_report_page(const PageOptions& options);

}  // namespace macula::bench
