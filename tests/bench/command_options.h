// Options that many experiments have, and their words.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace macula::bench {

/// `standard`: what is taken without it.
void add_scenes(CLI::App& command, std::vector<std::string>& scenes, const std::string& standard);
void add_size(CLI::App& command, const std::string& description, int& width_px, int& height_px);
void add_threads(CLI::App& command, int& threads);
void add_references(CLI::App& command, std::string& folder);
void add_json(CLI::App& command, std::string& file);
/// Of an experiment that goes on where it was interrupted.
void add_resumable_json(CLI::App& command, std::string& file);
/// The flag that Pace tells of.
void add_quick(CLI::App& command, const std::string& description);

}  // namespace macula::bench
