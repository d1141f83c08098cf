#include "tests/soak/process_size.h"

#include <unistd.h>
#include <algorithm>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace macula::soak {
namespace {

int entries_of(const std::string& folder) {
  std::error_code gone;
  const std::filesystem::directory_iterator begin(folder, gone);
  return gone ? 0 : static_cast<int>(std::distance(begin, std::filesystem::directory_iterator()));
}

}  // namespace

ProcessSize size_of(pid_t process, double at_s) {
  const std::string folder = "/proc/" + std::to_string(process);
  double total_pages = 0.0, resident_pages = 0.0;
  std::ifstream(folder + "/statm") >> total_pages >> resident_pages;
  const double page_mb = static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
  return {at_s, resident_pages * page_mb, entries_of(folder + "/fd"), entries_of(folder + "/task")};
}

double resident_slope_mb_per_h(const std::vector<ProcessSize>& sizes) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    for (std::size_t j = i + 1; j < sizes.size(); ++j) {
      const double hours = (sizes[j].at_s - sizes[i].at_s) / 3600.0;
      if (hours > 0.0) slopes.push_back((sizes[j].resident_mb - sizes[i].resident_mb) / hours);
    }
  }
  if (slopes.empty()) return 0.0;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return *middle;
}

}  // namespace macula::soak
