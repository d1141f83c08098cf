#include "tests/bench/command_options.h"

#include <CLI/CLI.hpp>

#include "tests/bench/arguments.h"

namespace macula::bench {

void add_scenes(CLI::App& command, std::vector<std::string>& scenes, const std::string& standard) {
  command.add_option("--scenes", scenes, "Built-in scenes or scene files")
      ->delimiter(',')
      ->option_text("NAME|FILE,... (" + standard + ")");
}

void add_size(CLI::App& command, const std::string& description, int& width_px, int& height_px) {
  const auto complaint = [](const std::string& text) -> std::string {
    const auto size = parse_size("--size", text);
    return size ? "" : size.error().what + " (" + size.error().remedy + ")";
  };
  const auto take = [&width_px, &height_px](const std::string& text) {
    const auto size = parse_size("--size", text);
    width_px = size->width_px, height_px = size->height_px;
  };
  command.add_option_function<std::string>("--size", take, description)
      ->check(complaint)
      ->option_text("WxH");
}

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "0 takes all the machine has")
      ->check(CLI::Range(0, 1024))
      ->option_text("N (0)");
}

void add_references(CLI::App& command, std::string& folder) {
  command.add_option("--references", folder, "Where half-references are kept")
      ->option_text("DIR (~/.cache/macula-bench)");
}

void add_json(CLI::App& command, std::string& file) {
  command.add_option("--json", file, "Write a report")->option_text("FILE.json");
}

void add_resumable_json(CLI::App& command, std::string& file) {
  command.add_option("--json", file, "Report; rows it holds already are kept")
      ->option_text("FILE.json");
}

void add_quick(CLI::App& command, const std::string& description) {
  command.add_flag("--quick", description);
}

}  // namespace macula::bench
