#include "tests/bench/streaming_link.h"

#include <algorithm>
#include <filesystem>

#include "shared/base/text.h"
#include "tests/support/link_trace.h"

namespace macula::bench {
namespace {

using namespace std::chrono_literals;
using support::LinkShape;

constexpr double kMbit = 1e6 / 8.0;

/// A link of this rate and one-way delay, with room for what is under way and 20 ms more.
LinkShape rated(double mbit_per_s, std::chrono::nanoseconds delay = 4ms) {
  LinkShape shape{.delay = delay, .bytes_per_s = mbit_per_s * kMbit};
  const double seconds = 1e-9 * static_cast<double>(delay.count()) + 0.02;
  shape.buffer_bytes =
      std::max<std::size_t>(static_cast<std::size_t>(shape.bytes_per_s * seconds), 32768);
  return shape;
}

std::vector<StreamingLink> plain_links() {
  LinkShape quick{.delay = 4ms, .buffer_bytes = 1U << 20};
  LinkShape jittery{.delay = 10ms, .jitter = 20ms, .buffer_bytes = 1U << 20};
  // TCP shows a loss as a round trip of standing still, and a little for the sender to notice.
  LinkShape lossy = quick;
  lossy.loss = 0.01;
  lossy.loss_stall = 9ms;
  std::vector<StreamingLink> links;
  const auto add = [&](const char* name, const LinkShape& shape) -> StreamingLink& {
    links.emplace_back();
    links.back().name = name;
    links.back().shape = shape;
    return links.back();
  };
  add("loopback", {}).has_proxy = false;
  add("100mbit", rated(100));
  add("30mbit", rated(30));
  add("10mbit", rated(10));
  add("4ms", quick);
  add("20+-10ms", jittery);
  add("loss-1pct", lossy);
  add("outage-200ms", quick).outage = 200ms;
  add("100-to-2mbit", rated(100)).slow_bytes_per_s = 2 * kMbit;
  return links;
}

bool is_other_direction(const std::string& stem) {
  return stem.size() > 3 && stem.substr(stem.size() - 3) == "_up";
}

Result<StreamingLink> recorded_link(const std::filesystem::path& file) {
  StreamingLink link;
  link.name = file.stem().string();
  LinkShape base{.delay = 10ms, .buffer_bytes = 65536};
  auto down = support::load_link_trace(file.string(), base);
  if (!down) return base::forward(down);
  auto up_file = file.string();
  if (const auto at = up_file.rfind("_down.csv"); at != std::string::npos) {
    up_file.replace(at, 9, "_up.csv");
  }
  auto up = support::load_link_trace(up_file, base);
  if (!up) return base::forward(up);
  link.down = std::move(*down);
  link.up = std::move(*up);
  return link;
}

}  // namespace

std::vector<std::string> plain_link_names() {
  std::vector<std::string> names;
  for (const StreamingLink& link : plain_links()) names.push_back(link.name);
  return names;
}

Result<StreamingLink> plain_link(const std::string& name) {
  std::string names;
  for (StreamingLink& link : plain_links()) {
    if (link.name == name) return std::move(link);
    names += (names.empty() ? "" : ", ") + link.name;
  }
  return base::bad_input("unknown link '" + name + "'", "--links", "there are: " + names);
}

Result<std::vector<StreamingLink>> recorded_links(const std::string& folder) {
  std::error_code failed;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const std::string stem = entry.path().stem().string();
    const bool is_recording = entry.path().extension() == ".csv" &&
                              (stem.rfind("lte_", 0) == 0 || stem.rfind("5g_", 0) == 0);
    if (is_recording && !is_other_direction(stem)) files.push_back(entry.path());
  }
  if (failed || files.empty())
    return base::bad_input("no recorded links (lte_*.csv, 5g_*.csv)", folder, "a folder of them");
  std::sort(files.begin(), files.end());
  std::vector<StreamingLink> links;
  for (const auto& file : files) {
    auto link = recorded_link(file);
    if (!link) return base::forward(link);
    links.push_back(std::move(*link));
  }
  return links;
}

}  // namespace macula::bench
