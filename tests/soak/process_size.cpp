#include "tests/soak/process_size.h"

#include <unistd.h>

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
  double mean_t = 0.0, mean_mb = 0.0;
  for (const ProcessSize& size : sizes) {
    mean_t += size.at_s / static_cast<double>(sizes.size());
    mean_mb += size.resident_mb / static_cast<double>(sizes.size());
  }
  double covariance = 0.0, variance = 0.0;
  for (const ProcessSize& size : sizes) {
    covariance += (size.at_s - mean_t) * (size.resident_mb - mean_mb);
    variance += (size.at_s - mean_t) * (size.at_s - mean_t);
  }
  return variance > 0.0 ? 3600.0 * covariance / variance : 0.0;
}

}  // namespace macula::soak
